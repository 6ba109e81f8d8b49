"""The robot's standard topics while a language model on board generates a long answer."""

import json
from collections.abc import Callable, Sequence

import pytest
from agent_process import READY, Agent
from bodies_rig import point
from geometry_msgs.msg import PoseStamped
from interop_rig import Messages, hear, tell
from peer import SENSOR, STATE, Peer, wait_until
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from tf2_msgs.msg import TFMessage

MODEL = "smollm2-135m-instruct"
STORY = "why is the sky blue and why do people like to look at it"
ANSWERS = 10
"""So many are asked for: on a fast machine one may be over before anything was due."""


class Teller:
    """An agent with a model, as a peer hears it that asks for long answers."""

    def __init__(self, peer: Peer) -> None:
        self.peer = peer
        self.tokens = hear(peer, String, "/edgevox/bot_token", SENSOR)
        self._state = peer.listen("state", STATE)

    def begin(self) -> Callable[[Sequence[Messages]], bool]:
        """Have it begin an answer; whether one of each was sent between two tokens of it.

        It is False once the answer has ended without that.
        """
        self.hush()
        tokens, states = len(self.tokens.messages), len(self._state.messages)
        self.peer.send("text_input", STORY)
        self.tokens.wait_for(lambda _: True, since=tokens)
        begun_ns = self.tokens.sent_ns[tokens]

        def between(heard: Sequence[Messages]) -> bool:
            def sent_between() -> bool:
                ended_ns = self.tokens.sent_ns[-1]
                return all(any(begun_ns < t < ended_ns for t in one.sent_ns) for one in heard)

            over = "listening"
            wait_until(lambda: sent_between() or over in self._state.messages[states:], "an end")
            return over not in self._state.messages[states:]

        return between

    def hush(self) -> None:
        """Have it listen."""
        self.peer.send("interrupt", "")
        self._state.wait_for(lambda m: m == "listening", since=len(self._state.messages) - 1)


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
    assert any(teller.begin()(heard) for _ in range(ANSWERS))


def test_a_goal_pose_does_not_wait_for_a_model_that_thinks(teller):
    deeds = hear(teller.peer, String, "/edgevox/agent_event")
    say = tell(teller.peer, PoseStamped, "/edgevox/goal_pose")

    def is_obeyed_meanwhile():
        between = teller.begin()
        say(point("base_link", 0.3, 0.0))
        return between([deeds])

    assert any(is_obeyed_meanwhile() for _ in range(ANSWERS))
    assert json.loads(deeds.messages[0].data)["kind"] == "skill_goal"
