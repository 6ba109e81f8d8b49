"""A robot file, the robot that it describes, the body that is made of both, and talk with it."""

import contextlib
import json
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from external_rig import robot_process
from guards import HUNG_S
from peer import STATE, Peer
from std_srvs.srv import Trigger
from waiting import wait_until

from edgevox.agent.skills import SkillSet
from edgevox.core.cancel import CancelToken
from edgevox.core.settings import Settings
from edgevox.ros2.external import EXTERNAL

ROBOT_FILE = Path(__file__).with_name("interface_robot.yaml")
NAMESPACE = "/robot1"
AGAIN_S = 5.0


def interfaces(domain: int, *arguments: str):
    """The robot's process."""
    return robot_process("interface_robot.py", *arguments, domain=domain, namespace=NAMESPACE)


class Asked:
    """What the robot was asked, as it tells it itself; and how it is changed."""

    def __init__(self, peer: Peer) -> None:
        self._peer = peer
        self.heard = peer.listen("asked", STATE)
        self._since = 0

    def anew(self) -> None:
        """It obeys again, and what it was asked until now is forgotten."""
        for change in ("obey", "shut", "heard"):
            self.do(change)
        self._since = len(self.heard.messages)

    def wait(self, what: str, value: object = None, *, since: int | None = None) -> None:
        """Until it was asked this; of a message those fields count that are given."""
        since = self._since if since is None else since

        def is_it(message: str) -> bool:
            found, its = json.loads(message)
            return found == what and (value is None or _has(its, value))

        self.heard.wait_for(is_it, since=since)

    @contextlib.contextmanager
    def within(self, what: str, value: object = None):
        """It is asked this because of what is done meanwhile."""
        since = len(self.heard.messages)
        yield
        self.wait(what, value, since=since)

    def times(self, what: str) -> int:
        return sum(json.loads(one)[0] == what for one in self.heard.messages[self._since :])

    def do(self, change: str) -> None:
        """Change it. One that has just started may not know us yet: what we sent is lost then."""
        since = len(self.heard.messages)
        for _ in range(int(HUNG_S / AGAIN_S)):
            self._peer.send("do", change)
            with contextlib.suppress(AssertionError):
                self.heard.wait_for(lambda one: json.loads(one) == ["do", change], AGAIN_S, since)
                return
        pytest.fail(f"the robot does not {change}")


def _has(found: object, wanted: object) -> bool:
    if isinstance(wanted, dict) and isinstance(found, dict):
        return all(name in found and _has(found[name], one) for name, one in wanted.items())
    if isinstance(wanted, list) and isinstance(found, list):
        return len(found) == len(wanted) and all(map(_has, found, wanted))
    return bool(found == wanted)


@contextlib.contextmanager
def lasting(domain: int):
    """The robot, for all tests of a module, and what it is asked: `anew` for each of them."""
    with interfaces(domain), contextlib.closing(Peer(domain, NAMESPACE)) as peer:
        yield Asked(peer)


class Talk:
    """Things said to the agent, and its answers."""

    def __init__(self, peer: Peer) -> None:
        self._peer = peer
        self._heard = peer.listen("response")

    def say(self, text: str, *parts: str) -> None:
        """Say something, and wait for an answer with each of these, one after another."""
        with self.told(*parts):
            self._peer.send("text_input", text)

    @contextlib.contextmanager
    def told(self, *parts: str):
        """Answers with these come because of what is done meanwhile."""
        since = len(self._heard.messages)
        yield
        for part in parts:
            since = self._first(lambda one, part=part: part in one, since)[0] + 1

    def answer(self, text: str, *, after: str = "") -> str:
        """The first answer to this but for `after`, which a skill says when it begins."""
        since = len(self._heard.messages)
        self._peer.send("text_input", text)
        return self._first(lambda one: not after or after not in one, since)[1]

    def ask_until(self, text: str, part: str, *, after: str = "") -> None:
        """Ask again and again until the answer has this: what was heard last stays true a while."""

        wait_until(lambda: part in self.answer(text, after=after), part)

    def speak(self, language: str) -> None:
        """Go on in another language."""
        self._peer.send("set_language", language)
        wait_until(lambda: self._language() == language, f"language {language}")

    def _first(self, is_it: Callable[[str], bool], since: int) -> tuple[int, str]:
        """The first such answer, and its number."""
        self._heard.wait_for(is_it, since=since)
        told = self._heard.messages
        return next((at, told[at]) for at in range(since, len(told)) if is_it(told[at]))

    def _language(self) -> str:
        service = self._peer.name("list_languages")
        answer = self._peer.call(Trigger, service, Trigger.Request())
        return str(json.loads(answer.message)["current"])


class Run:
    """One call of a skill, on a thread of its own."""

    def __init__(self, skills: SkillSet, name: str, **arguments: object) -> None:
        self.token, self.reports = CancelToken(), []
        self._pool = ThreadPoolExecutor(1)
        one = skills[name]
        self._future = self._pool.submit(one.function, self, **one.validate(arguments))

    def report(self, **feedback: object) -> None:
        self.reports.append(feedback)

    def result(self):
        try:
            return self._future.result(HUNG_S)
        finally:
            self._pool.shutdown(wait=False)


@contextlib.contextmanager
def body(file: Path = ROBOT_FILE):
    """The skills of a started body that the file describes."""
    one = EXTERNAL.build(Settings(robot_file=file), None)
    one.start()
    try:
        yield SkillSet(one.skills)
    finally:
        one.close()


__all__ = ["NAMESPACE", "ROBOT_FILE", "Asked", "Run", "Talk", "body", "interfaces", "lasting"]
