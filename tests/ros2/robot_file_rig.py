"""A robot file, the robot of interfaces that it describes, and the body that is made of both."""

import contextlib
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from external_rig import robot_process
from guards import HUNG_S
from peer import STATE, Peer

from edgevox.agent.skills import SkillSet
from edgevox.core.cancel import CancelToken
from edgevox.core.settings import Settings
from edgevox.ros2.external import EXTERNAL

ROBOT_FILE = Path(__file__).with_name("interface_robot.yaml")
NAMESPACE = "/robot1"


def interfaces(domain: int, *arguments: str):
    """The robot's process."""
    return robot_process("interface_robot.py", *arguments, domain=domain, namespace=NAMESPACE)


class Asked:
    """What the robot was asked, as it tells it itself; and how it is changed."""

    def __init__(self, peer: Peer) -> None:
        self._peer = peer
        self.heard = peer.listen("asked", STATE)

    def wait(self, what: str, value: object = None, *, since: int = 0) -> None:
        wanted = [what, value]
        self.heard.wait_for(
            lambda m: json.loads(m) == wanted or (value is None and json.loads(m)[0] == what),
            since=since,
        )

    def times(self, what: str) -> int:
        return sum(json.loads(one)[0] == what for one in self.heard.messages)

    def do(self, change: str) -> None:
        since = len(self.heard.messages)
        self._peer.send("do", change)
        self.wait("do", change, since=since)


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


__all__ = ["NAMESPACE", "ROBOT_FILE", "Asked", "Run", "body", "interfaces"]
