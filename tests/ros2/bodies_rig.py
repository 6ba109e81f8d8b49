"""A body in a process of its own, and everything that its contract lets a peer hear of it."""

import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import yaml
from action_rig import Client
from agent_process import READY, Agent
from geometry_msgs.msg import PoseStamped
from guards import HUNG_S
from interop_rig import hear
from peer import STATE, Peer

from tf2_msgs.msg import TFMessage

CONTRACT = yaml.safe_load((Path(__file__).parent / "contract.yaml").read_text(encoding="utf-8"))
OF_BODIES = {*CONTRACT["robot_interop"], "odom", "camera_info", "/tf_static"}


class Live:
    """An agent that runs, and a peer that has listened to it since it was ready."""

    def __init__(self, process: Agent, peer: Peer) -> None:
        self.process, self.peer = process, peer
        self._state = peer.listen("robot_state", STATE)
        self._response = peer.listen("response")
        self._event = peer.listen("agent_event")

    def say(self, text: str) -> "Since":
        """What was heard after this was said."""
        since = self.from_now()
        self.peer.send("text_input", text)
        return since

    def from_now(self) -> "Since":
        """What is heard from now on."""
        heard = (self._state, self._response, self._event)
        return Since(*heard, *(len(one.messages) for one in heard))

    def state(self) -> dict[str, Any]:
        """The body as it is: the first state that comes from now on."""
        return self.from_now().state(lambda _: True)

    def offered(self) -> set[str]:
        """Topics of the body itself that this process publishes or takes."""
        return {name for name in OF_BODIES if self._has(full(name))}

    def _has(self, topic: str) -> bool:
        node = self.peer.node
        ends = (
            *node.get_publishers_info_by_topic(topic),
            *node.get_subscriptions_info_by_topic(topic),
        )
        return any(end.node_name == CONTRACT["node"] for end in ends)


class Since:
    """What a peer hears from some moment on, as data."""

    def __init__(self, state, response, event, states, responses, events) -> None:
        self._state, self._states = state, states
        self._response, self._responses = response, responses
        self._event, self._events = event, events

    def state(
        self, wanted: Callable[[dict[str, Any]], bool], timeout_s: float = HUNG_S
    ) -> dict[str, Any]:
        """The first state of the body that is wanted."""
        return self._data(self._state, wanted, timeout_s, self._states)

    def event(self, kind: str, status: str | None = None, **wanted: Any) -> dict[str, Any]:
        """The first event of this kind, with this status and these other values."""
        asked = {"kind": kind, **({"status": status} if status else {}), **wanted}
        return self._data(self._event, lambda e: asked.items() <= e.items(), HUNG_S, self._events)

    def answer(self, part: str) -> str:
        """The first answer that has this in it."""
        return self._response.wait_for(lambda m: part in m, since=self._responses)

    @staticmethod
    def _data(heard, wanted, timeout_s: float, since: int) -> dict[str, Any]:
        read: dict[str, dict[str, Any]] = {}

        def fits(message: str) -> bool:
            return wanted(read.setdefault(message, json.loads(message)))

        return json.loads(heard.wait_for(fits, timeout_s, since))


@contextmanager
def on_ros2(robot: str, domain: int, *arguments: str) -> Iterator[Live]:
    """Start this robot without a model, and listen to it."""
    flags = ("--text-mode", "--ros2", "--no-render", "--llm", "none", *arguments)
    process = Agent(robot, *flags, domain=domain)
    try:
        process.wait_for_line(READY)
        peer = Peer(domain)
        try:
            yield Live(process, peer)
        finally:
            peer.close()
    finally:
        code = process.terminate()
        assert code == 0, process.output


def full(name: str) -> str:
    return name if name.startswith("/") else f"/edgevox/{name}"


def missing_skills(live: Live, robot: str) -> set[str]:
    """Those that the contract promises for this robot and the action does not know."""
    client = Client(live.peer)
    since = live.from_now()
    assert not client.send("no_such_skill").accepted
    refused = since.event("skill_goal", "rejected")["error"]
    known = refused.partition("expected one of ")[2].split(", ")
    client.destroy()
    return set(CONTRACT["skills"][robot]) - set(known)


def frames_of(live: Live, topic: str = "/tf", qos: Any = STATE) -> set[tuple[str, str]]:
    """Parents and children of the transforms in the first message that comes."""
    message = hear(live.peer, TFMessage, topic, qos).wait_for(lambda _: True)
    return {(one.header.frame_id, one.child_frame_id) for one in message.transforms}


def point(frame: str, x: float, y: float, z: float = 0.0) -> PoseStamped:
    """A goal."""
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
    return message


def moves(state: dict[str, Any]) -> bool:
    """Of a body on wheels or legs."""
    velocity = state["velocity"]
    return abs(velocity["linear"]) > 0.1 or abs(velocity["angular"]) > 0.2


def stands(state: dict[str, Any]) -> bool:
    velocity = state["velocity"]
    return abs(velocity["linear"]) < 0.02 and abs(velocity["angular"]) < 0.05


def walked_m(before: dict[str, Any], after: dict[str, Any]) -> float:
    """Metres between two states, along the way that the first looks."""
    one, other = before["pose"], after["pose"]
    x, y = other["x"] - one["x"], other["y"] - one["y"]
    return math.cos(one["yaw"]) * x + math.sin(one["yaw"]) * y


def turned_deg(before: dict[str, Any], after: dict[str, Any]) -> float:
    """Degrees to the left between two states, -180 to 180."""
    return math.degrees(math.remainder(after["pose"]["yaw"] - before["pose"]["yaw"], math.tau))
