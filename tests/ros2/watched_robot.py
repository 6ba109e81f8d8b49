"""A robot that is asked by every way in and stopped by every way, and whose velocity is watched.

All that this process sends has left when the call that sends it returns, and lies in a queue of the
robot once `has_received`. So what was sent before a stop, and what after it, is no matter of time.
"""

import json
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path

from geometry_msgs.msg import PoseStamped, Twist
from guards import HUNG_S
from halting import BRAKED_S, stands_for_good
from interop_rig import Stream, tell, twist
from paired_page import PairedPage
from peer import RELIABLE
from ports import free_port
from rclpy.duration import Duration
from robot_states import standing
from std_msgs.msg import String
from stop_rig import TARGETS, Robot
from waiting import wait_until

from edgevox_msgs.action import ExecuteSkill

TURNS = 0.8
"""rad/s of a stream: it turns on the spot, and so runs into nothing."""
STICK_HZ = 10.0
LET_GO_S = 0.8
"""Longer than a stream must pause to count again, also by clocks that run a little differently."""
STEADY_S = 0.4
"""Whoever was silent for so long may have been taken to have let go."""
WATCHED_S = 2.0
"""Whatever is on its way when it is stopped would move it by then."""


class WatchedRobot(Robot):
    """An agent with a model that never comes to an end, its console, and all who talk to it."""

    def __init__(self, domain: int, folder: Path) -> None:
        super().__init__(
            domain,
            *("--console", f"--console-folder={folder}", "--console-tls=off"),
            *("--console-host=127.0.0.1", f"--console-port={free_port()}"),
        )
        self.thinker.primed.set()
        self.page = PairedPage(self.agent.wait_for_line("/#pair=").strip())
        self.pose_goal = tell(self.peer, PoseStamped, "/edgevox/goal_pose")
        self.velocity = tell(self.peer, Twist, "/edgevox/cmd_vel")
        self.last = self.peer.node.create_publisher(String, self.peer.name("take_over"), RELIABLE)
        wait_until(self.last.get_subscription_count, "take_over")
        self.language = self.peer.node.create_publisher(
            String, self.peer.name("set_language"), 10
        ).publish

    def close(self) -> None:
        self.page.close()
        super().close()

    @property
    def own_s(self) -> float:
        """Its own time."""
        return float(self.newest()["time"])

    @property
    def x(self) -> float:
        return float(self.newest()["pose"]["x"])

    def target(self) -> Mapping[str, float]:
        """A point that is a long way from here."""
        return TARGETS[self.x < 5.0]

    def sentence_to(self, language: str = "en") -> str:
        """Words for a drive that takes a while."""
        rooms = ("kitchen", "bedroom") if language == "en" else ("Küche", "Schlafzimmer")
        return ("go to the {}" if language == "en" else "fahr zu {}").format(rooms[self.x > 5.0])

    def send_goals(self, number: int) -> None:
        """As many requests in a burst."""
        rooms = ("bedroom", "kitchen", "office")
        goals = [
            ExecuteSkill.Goal(
                skill_name="navigate_to", arguments_json=json.dumps({"room": rooms[one % 3]})
            )
            for one in range(number)
        ]
        self.client.send_without_waiting(goals)

    def has_received(self) -> None:
        """Wait until the robot's middleware has what was sent: it acknowledges what is sent now.

        What a process sends to another one comes there in its order; a page's stop comes by itself.
        """
        self.last.publish(String(data="nobody"))
        assert self.last.wait_for_all_acked(Duration(seconds=HUNG_S)), "the robot hears nothing"

    def send_pose(self) -> None:
        goal, target = PoseStamped(), self.target()
        goal.header.frame_id = "map"
        goal.pose.position.x, goal.pose.position.y = target["x"], target["y"]
        goal.pose.orientation.w = 1.0
        self.pose_goal(goal)

    def think(self) -> None:
        """It answers at length; wait until it does."""
        self.thinker.tells.clear()
        self.peer.send("text_input", "why is the sky blue")
        self.thinker.tells.wait()

    def stick(self) -> Stream:
        """Somebody holds the page's stick."""
        return Stream(
            lambda turns: self.page.send(type="drive", linear=0.0, angular=turns), TURNS, STICK_HZ
        )

    def let_go(self) -> None:
        self.page.send(type="drive", linear=0.0, angular=0.0)

    def joystick(self) -> Stream:
        """A node that streams on `cmd_vel`."""
        return Stream(self.velocity, twist(0.0, TURNS))

    # What is seen

    def has_heard_all(self) -> None:
        """Wait until what was sent until now was received, whatever way it took.

        A topic keeps its order only for itself. What an executor has not seen when it looked for
        the first answer, it has when it looked for the second, and handled before the third. The
        states from before are taken, too: of a burst this process may be seconds behind.
        """
        for _ in range(3):
            self.has_looked()
        self.page.has_answered_pings()
        self.peer.catch_up()

    def moves(self) -> None:
        """Wait until it does."""
        self.state.wait_for(lambda one: not standing(one), since=len(self.state.messages))

    def passes(self, seconds: float) -> None:
        """Wait until so much of its own time is over."""
        until_s = self.own_s + seconds
        self.state.wait_for(
            lambda one: json.loads(one)["time"] >= until_s, since=len(self.state.messages) - 1
        )

    def stays(self, seconds: float = WATCHED_S) -> None:
        """It was told that it has stopped: it brakes, and then stands and has no goal."""
        since, braked_s = len(self.state.messages) - 1, self.own_s + BRAKED_S
        self.passes(seconds)
        late = [
            state
            for state in map(json.loads, self.state.messages[since:])
            if state["time"] > braked_s and not stands_for_good(json.dumps(state))
        ]
        assert not late, f"it stopped at {braked_s - BRAKED_S} s, and then: {late[0]}"

    def was_steady(self, since: int) -> bool:
        """Whether neither it nor this machine has been silent so long that a stream had a pause."""
        times = self.state.times[since:]
        return all(two - one < STEADY_S for one, two in pairwise(times))


def _by_text(robot: WatchedRobot, word: str) -> None:
    heard = len(robot.words.messages)
    robot.peer.send("text_input", word)
    robot.words.wait_for(lambda one: one == word, since=heard)


def _by_standard_input(robot: WatchedRobot, word: str) -> None:
    heard = len(robot.words.messages)
    robot.type(word)
    robot.words.wait_for(lambda one: one == word, since=heard)


def _by_skill(robot: WatchedRobot, _word: str) -> None:
    assert robot.client.end_of(robot.client.send("stop"))[0] == "succeeded"


def _by_interrupt(robot: WatchedRobot, _word: str) -> None:
    robot.interrupt.publish(String())


def _by_reset(robot: WatchedRobot, _word: str) -> None:
    robot.peer.send("command", "reset")


def _by_button(robot: WatchedRobot, _word: str) -> None:
    robot.page.ask(type="stop")


def _by_pages_word(robot: WatchedRobot, word: str) -> None:
    robot.page.ask(type="text", text=word)


def _by_pages_skill(robot: WatchedRobot, _word: str) -> None:
    robot.page.ask(type="skill", name="stop", arguments={})


BUTTON = "the page's button"
STOPS: Mapping[str, Callable[[WatchedRobot, str], None]] = {
    "text_input": _by_text,
    "interrupt": _by_interrupt,
    "execute_skill stop": _by_skill,
    "command reset": _by_reset,
    "standard input": _by_standard_input,
    BUTTON: _by_button,
    "a word on the page": _by_pages_word,
    "the skill on the page": _by_pages_skill,
}
"""Each is given a stop word, and waits until it is told, where somebody is told."""


def stop(robot: WatchedRobot, way: str, word: str = "stop") -> None:
    """Stop it, and wait until all that was sent was received."""
    STOPS[way](robot, word)
    robot.has_heard_all()


def resume(robot: WatchedRobot) -> None:
    """Allow motion again."""
    robot.page.ask(type="resume")
    robot.has_heard_all()
