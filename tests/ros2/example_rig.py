"""A robot file of the examples with an agent that has nothing else, and a robot that stands in."""

import contextlib
from pathlib import Path

import phrases
import pytest
from agent_process import READY, Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from external_rig import EXAMPLES, robot_process
from guards import HUNG_S
from interface_overlay import build_overlay, overlaid
from peer import RELIABLE, Peer
from robot_file_rig import Asked, Talk
from waiting import Heard


def file_of(name: str) -> Path:
    """The robot file of the example of this name."""
    folder = EXAMPLES / name
    return folder / "robot.yaml" if folder.is_dir() else folder.with_suffix(".yaml")


def play(name: str, scenario: str, domain: int) -> tuple[int, str]:
    """How an agent of its own ends that plays a scenario of the example, and what it tells."""
    agent = Agent(
        "robot-external", "--llm=none", f"--robot-file={file_of(name)}",
        f"--scenario={EXAMPLES / name / 'scenarios' / scenario}.yaml", domain=domain,
    )  # fmt: skip
    return agent.process.wait(HUNG_S), agent.output


class Example:
    """A conversation about the robot, and the robot, which may die and come again."""

    def __init__(self, name: str, domain: int) -> None:
        self._name, self._domain = name, domain
        self._robot = contextlib.ExitStack()
        self.robot_starts()
        self.peer, self._robot_peer = Peer(domain), Peer(domain, "")
        self.talk, self.asked = Talk(self.peer), Asked(self._robot_peer)

    def close(self) -> None:
        self._robot.close()
        self.peer.close()
        self._robot_peer.close()

    def assert_it_drives_nowhere(self, refusal: str) -> None:
        """Asked to drive it refuses with this, and nothing of driving is heard or published."""
        assert self.talk.answer("go to the kitchen").startswith(refusal)
        where = self.talk.answer("where are you")
        assert where == phrases.said("not_known"), where
        not_done = phrases.opening("not_understood_but"), phrases.said("no_ability")
        for sentence in ("remember this place as den", "go to x 1 y 2"):
            answer = self.talk.answer(sentence)
            assert answer.startswith(not_done), answer
        for sentence in ("come back", "go back there"):
            assert self.talk.answer(sentence) == phrases.refused("cannot_drive")
        topics = {name for name, _ in self.peer.node.get_topic_names_and_types()}
        assert "/edgevox/response" in topics
        assert not topics & {"/odom", "/scan", "/cmd_vel", "/goal_pose", "/edgevox/pose", "/tf"}
        self._is_well()

    def _is_well(self) -> None:
        """Its diagnostics miss nothing of its body."""
        heard = Heard[DiagnosticArray]()
        self.peer.node.create_subscription(DiagnosticArray, "/diagnostics", heard.add, RELIABLE)
        found = {one.name: one for one in heard.wait_for(lambda array: array.status).status}
        body = found["/edgevox/edgevox: sim"]
        assert (body.level, body.message) == (DiagnosticStatus.OK, "runs")

    def robot_starts(self) -> None:
        own = f"{self._name}/robot.py"
        script = own if (EXAMPLES / own).is_file() else f"{self._name}_robot.py"
        one = robot_process(script, domain=self._domain, namespace="/")
        self._process = self._robot.enter_context(one)

    def robot_dies(self) -> None:
        """At once: it says no goodbye."""
        self._process.kill()
        self._robot.close()


@contextlib.contextmanager
def example(
    name: str,
    *packages: str,
    domain: int,
    cache: Path,
    first: tuple[str, str, str] | None = None,
    file: Path | None = None,
):
    """The example of this name, which is talked to in English; it needs these packages.

    `first` is an order, what it says when it begins and when it is done: once it is done the agent
    has found the robot, which takes a while beside others. `file` is the robot file where it is no
    example of ours.
    """
    prefixes = build_overlay(packages, cache)
    with pytest.MonkeyPatch.context() as patch, contextlib.ExitStack() as running:
        for variable, value in overlaid(prefixes).items():
            patch.setenv(variable, value)
        described = file or file_of(name)
        agent = Agent(
            "robot-external", "--text-mode", "--ros2", "--llm=none", f"--robot-file={described}",
            domain=domain,
        )  # fmt: skip
        running.callback(agent.terminate)
        one = Example(name, domain)
        running.callback(one.close)
        agent.wait_for_line(READY)
        if first:
            order, begins, done = first
            one.talk.ask_until(order, done, after=begins)
        yield one
