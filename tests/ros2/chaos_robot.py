"""The node that the chaos is for: its process, what that takes, and its first minute.

What it must be able to do, it is asked the same way before the chaos and after it.
"""

import http.client
import json
import os
import time
from dataclasses import dataclass
from typing import Any

from action_rig import Client
from agent_process import Agent
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Twist
from interop_rig import Stream, hear, twist
from peer import STATE, Peer, done
from process_memory import process_memory
from rclpy.qos import QoSProfile
from robot_states import moving, standing
from waiting import wait_until

from edgevox_msgs.action import ExecuteSkill

ANSWER_S, STAND_S, ARRIVE_S, THINK_S = 60.0, 2.0, 120.0, 120.0
"""The longest that an answer, a stop, a drive and a sentence for the model may take, loaded as the
machine may be."""
WATCHDOG_S = 0.5
PATIENCE_S = 5.0
QUIET_S = 2.0
WELL_S = 30.0
DIAGNOSTICS = QoSProfile(depth=10)


@dataclass(frozen=True)
class Taken:
    """What a process takes from the machine."""

    own_mb: float
    rss_mb: float
    threads: int
    files: int

    def __str__(self) -> str:
        return (
            f"{self.own_mb:.0f} MB its own, {self.rss_mb:.0f} MB resident, "
            f"{self.threads} threads, {self.files} files"
        )


class Robot:
    """The agent's process and a peer that talks to it."""

    def __init__(self, agent: Agent, peer: Peer, health_port: int) -> None:
        self.agent, self.peer = agent, peer
        self._health_port = health_port
        self.response = peer.listen("response")
        self.state = peer.listen("robot_state", STATE)
        self.doing = peer.listen("state", STATE)
        self.client = Client(peer)
        self.cmd_vel = peer.node.create_publisher(Twist, peer.name("cmd_vel"), QoSProfile(depth=10))
        wait_until(lambda: self.cmd_vel.get_subscription_count() > 0, "cmd_vel")

    @property
    def pid(self) -> int:
        return self.agent.process.pid

    def check_alive(self) -> None:
        """It runs, and says of itself that it can do its work."""
        assert self.agent.process.poll() is None, f"it ended: {self.agent.process.returncode}"

    def check_live(self) -> None:
        connection = http.client.HTTPConnection("127.0.0.1", self._health_port, timeout=10)
        try:
            connection.request("GET", "/live")
            answer = connection.getresponse()
            assert answer.status == 200, answer.read()
        finally:
            connection.close()

    def check_well(self) -> None:
        """No component says of itself that it fails, but for a model server that is off."""

        def errors(message: DiagnosticArray) -> list[str]:
            found = [s for s in message.status if s.level >= DiagnosticStatus.ERROR]
            return [f"{s.name}: {s.message}" for s in found if not s.name.endswith(": llm")]

        heard = hear(self.peer, DiagnosticArray, "/diagnostics", DIAGNOSTICS)
        try:
            heard.wait_for(lambda m: not errors(m), WELL_S)
        except AssertionError:
            raise AssertionError(errors(heard.messages[-1]) or "nothing on /diagnostics") from None

    def taken(self) -> Taken:
        memory = process_memory(self.pid)
        return Taken(
            own_mb=memory.own_mb,
            rss_mb=memory.rss_mb,
            threads=memory.threads,
            files=len(os.listdir(f"/proc/{self.pid}/fd")),
        )

    def how_it_is(self) -> str:
        """For whoever finds out why it failed."""
        code = self.agent.process.poll()
        if code is not None:
            return f"gone with exit code {code}"
        try:
            self.check_live()
            live = "live"
        except (AssertionError, OSError) as error:
            live = f"not live: {error!r}"
        return f"{self.taken()}, {live}"

    def settle(self) -> None:
        """Everything that was asked is forgotten: it listens, in English, and stands."""
        deadline_s = time.monotonic() + 60.0
        while True:
            self.check_alive()
            for topic, text in (
                ("set_language", "en"), ("set_voice", ""), ("command", "unmute"),
                ("command", "reset"), ("interrupt", ""),
            ):  # fmt: skip
                self.peer.send(topic, text)
            heard, changes = len(self.response.messages), len(self.doing.messages)
            time.sleep(QUIET_S)
            quiet = (heard, changes) == (len(self.response.messages), len(self.doing.messages))
            if quiet and self.doing.messages[-1] == "listening" and standing(self._newest()):
                return
            last = self.doing.messages[-9:]
            assert time.monotonic() < deadline_s, f"it does not come to rest: {last}"

    def think(self) -> None:
        """Answers what its model must answer, in whatever language it speaks."""
        states, answers = len(self.doing.messages), len(self.response.messages)
        self.peer.send("text_input", "why does ice float?")
        self.doing.wait_for(lambda m: m == "thinking", ANSWER_S, states)
        self.response.wait_for(lambda _: True, THINK_S, answers)

    def first_minute(self) -> dict[str, float]:
        """Answers, drives and stops; seconds that each took."""
        took = {"answer": self._answer("what is your battery", "percent", ANSWER_S)}
        rooms = ("kitchen", "bedroom")
        room = rooms[json.loads(self._newest()).get("room") == rooms[0]]
        self._answer(f"go to the {room}", room, ANSWER_S)
        self._moves()
        took["drive"] = self._heard(f"I am in the {room}", ARRIVE_S)
        self._drive()
        took["stop"] = self._stands(lambda: self.peer.send("text_input", "stop"))
        self._heard("Stopped", ANSWER_S)
        self._drive()
        took["interrupt"] = self._stands(lambda: self.peer.send("interrupt", ""))
        took["watchdog"] = self._watchdog()
        took["model"] = self._answer("why does ice float?", "", THINK_S)
        took["goal"] = self._goal()
        return took

    def ask_goals(self, goals: list[tuple[str, str]]) -> tuple[list[Any], int]:
        """Those that were accepted, and how many got no answer: in a flood ROS 2 loses requests."""
        messages = [ExecuteSkill.Goal(skill_name=n, arguments_json=a) for n, a in goals]
        futures = self.client.send_without_waiting(messages)
        deadline_s = time.monotonic() + PATIENCE_S
        handles, unanswered = [], 0
        for future in futures:
            try:
                handles.append(done(future, max(0.1, deadline_s - time.monotonic())))
            except AssertionError:
                unanswered += 1
        return [one for one in handles if one.accepted], unanswered

    def stop_works(self) -> float:
        """In the middle of whatever goes on: it drives, is told to stop, and stands."""
        for target in ("x 3 y 4", "x 8 y 8") * 5:
            since = len(self.state.messages)
            self.peer.send("text_input", f"drive to {target}")
            try:
                self.state.wait_for(moving, 2.0, since)
                break
            except AssertionError:  # it is there already, or others told it otherwise
                continue
        return self._stands(lambda: self.peer.send("interrupt", ""))

    def _newest(self) -> str:
        return self.state.wait_for(lambda _: True, 10.0, len(self.state.messages))

    def _answer(self, text: str, part: str, within_s: float) -> float:
        since, begun = len(self.response.messages), time.monotonic()
        self.peer.send("text_input", text)
        self.response.wait_for(lambda m: part in m, within_s, since)
        return time.monotonic() - begun

    def _heard(self, part: str, within_s: float) -> float:
        begun = time.monotonic()
        since = max(0, len(self.response.messages) - 1)
        self.response.wait_for(lambda m: part in m, within_s, since)
        return time.monotonic() - begun

    def _moves(self) -> None:
        self.state.wait_for(moving, ANSWER_S, len(self.state.messages))

    def _drive(self) -> None:
        here = json.loads(self._newest())["pose"]
        target = "x 3 y 4" if here["x"] > 5 else "x 8 y 8"
        self.peer.send("text_input", f"drive to {target}")
        self._moves()

    def _stands(self, stop) -> float:
        since, begun = len(self.state.messages), time.monotonic()
        stop()
        self.state.wait_for(standing, STAND_S, since)
        return time.monotonic() - begun

    def _watchdog(self) -> float:
        """How long after the last velocity it stands."""
        since = len(self.state.messages)
        stream = Stream(self.cmd_vel.publish, twist(0.0, 0.8))
        self.state.wait_for(
            lambda m: abs(json.loads(m)["velocity"]["angular"]) > 0.1, ANSWER_S, since
        )
        ended, since = stream.end(), len(self.state.messages)
        self.state.wait_for(standing, WATCHDOG_S + STAND_S, since)
        return time.monotonic() - ended

    def _goal(self) -> float:
        begun = time.monotonic()
        assert self.client.end_of(self.client.send("get_pose"))[0] == "succeeded"
        goal = self.client.send("navigate_to", room="living_room")
        self.client.cancel(goal)
        assert self.client.end_of(goal)[0] == "canceled"
        return time.monotonic() - begun


__all__ = ["Robot", "Taken", "done"]
