"""The robot's standard topics while a language model on board generates an answer."""

import json
from collections.abc import Callable, Sequence

import pytest
from agent_process import READY, Agent
from bodies_rig import point
from geometry_msgs.msg import PoseStamped
from interop_rig import hear, tell
from peer import SENSOR, STATE, Peer
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from waiting import wait_until

from tf2_msgs.msg import TFMessage

pytestmark = pytest.mark.long

MODEL = "smollm2-135m-instruct"
STORY = "why does ice float?"
ANSWERS = 10
"""So many are asked for: on a fast machine one may be over before anything was due."""


Times = Callable[[], Sequence[Sequence[int]]]
"""When messages were sent, a sequence for each topic."""


class Teller:
    """An agent with a model, as a peer hears it that asks for long answers."""

    def __init__(self, peer: Peer) -> None:
        self.peer = peer
        self.tokens = hear(peer, String, "/edgevox/bot_token", SENSOR)
        self._state = hear(peer, String, "/edgevox/state", STATE)

    def begin(self) -> Callable[[Times], bool]:
        """Have it begin an answer; whether one of each was sent before it ended.

        It is False if the answer has ended without that. In any case it listens again.
        """
        tokens, states = len(self.tokens.messages), len(self._state.messages)
        self.peer.send("text_input", STORY)
        self._state.wait_for(lambda m: m.data == "thinking", since=states)
        begun = [one.data for one in self._state.messages].index("thinking", states)
        first_ns = self._state.sent_ns[begun]

        def over() -> bool:
            return any(one.data == "listening" for one in self._state.messages[begun:])

        def between(times_ns: Times) -> bool:
            def sent() -> bool:
                last_ns = (self.tokens.sent_ns[tokens:] or [first_ns])[0]
                return all(any(first_ns < t < last_ns for t in one) for one in times_ns())

            wait_until(lambda: sent() or over(), "one of each, or the answer's end")
            wait_until(over, "the answer's end")
            return sent()

        return between


@pytest.fixture(scope="module")
def teller(domain):
    one = Agent("robot-apartment", "--text-mode", "--ros2", "--llm", MODEL, domain=domain)
    try:
        one.wait_for_line(READY)
        peer = Peer(domain)
        yield Teller(peer)
        peer.close()
    finally:
        one.terminate()


def test_what_comes_at_a_rate_comes_while_a_model_generates(teller):
    heard = (
        hear(teller.peer, TFMessage, "/tf", SENSOR),
        hear(teller.peer, PoseStamped, "/edgevox/pose", SENSOR),
        hear(teller.peer, LaserScan, "/edgevox/scan", SENSOR),
    )
    for one in heard:
        one.wait_for(lambda _: True)
    times = [one.sent_ns for one in heard]
    assert any(teller.begin()(lambda: times) for _ in range(ANSWERS))


def test_a_goal_pose_does_not_wait_for_a_model_that_thinks(teller):
    events = hear(teller.peer, String, "/edgevox/agent_event")
    say = tell(teller.peer, PoseStamped, "/edgevox/goal_pose")

    def running_ns():
        heard = zip(events.messages, events.sent_ns, strict=False)  # one may come meanwhile
        return [t for event, t in heard if json.loads(event.data).get("status") == "running"]

    def is_obeyed_meanwhile():
        between = teller.begin()
        say(point("base_link", 0.3, 0.0))
        return between(lambda: [running_ns()])

    assert any(is_obeyed_meanwhile() for _ in range(ANSWERS))
