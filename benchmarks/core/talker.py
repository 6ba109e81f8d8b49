"""An agent in a process of its own, as users start it, and a peer that talks to it over ROS 2."""

import json
import os
import random
import time
from collections.abc import Callable, Sequence

from agent_process import AGENT, Agent
from peer import RELIABLE, SENSOR, STATE, Peer
from waiting import Heard, wait_until

PLAIN = ("where are you", "go to the kitchen", "go to the bedroom", "what is your battery level")
READ = (
    "I would like you over in the kitchen, please",
    "off you go to the bedroom",
    "let's have you in the living room",
    "get yourself to the kitchen, please",
)
"""No template knows these: they are read and judged."""
QUESTIONS = (
    "how do bees make honey",
    "what is a lighthouse good for",
    "why do cats sleep so much",
    "why is the sea salty",
)
"""What the model answers, in words."""
STORY = "why is the sky blue and why do people like to look at it"
"""Answered in many words, so that there is time to interrupt."""
ROOMS = ("bedroom", "office", "kitchen")
SETTLE_S = 0.3
"""Two topics have no order between them; after this long the first message has arrived."""
__all__ = [
    "PLAIN",
    "QUESTIONS",
    "READ",
    "RELIABLE",
    "Talker",
    "isolate",
    "start_aloud_s",
    "wait_until",
]

STANDING = ("Stopped.", "I am standing still.")


def isolate() -> int:
    """A domain that is probably free, on this machine only; what is started inherits both."""
    domain = random.Random().randrange(1, 100)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(domain)
    return domain


def start_aloud_s() -> float:
    """How long an agent takes until it hears, with the default model and no sound card."""
    began = time.monotonic()
    agent = Agent("robot-apartment", "--audio-in=none", "--audio-out=none", domain=isolate())
    try:
        agent.wait_for_line("is ready", timeout_s=120)
        return time.monotonic() - began
    finally:
        agent.terminate()


class Talker:
    """The agent, and what a peer of it hears. `start_s` is how long it took to be ready."""

    def __init__(self, *arguments: str, program: Sequence[str] = (AGENT,)) -> None:
        self.domain = domain = isolate()
        started = time.monotonic()
        given = (*program[1:], "robot-apartment", "--text-mode", "--ros2", *arguments)
        self.agent = Agent(*given, domain=domain, program=program[0])
        self.agent.wait_for_line("is ready", timeout_s=120)
        self.start_s = time.monotonic() - started
        self.peer = Peer(domain)
        self.sentence = self.peer.listen("bot_sentence", RELIABLE)
        self.token = self.peer.listen("bot_token", SENSOR)
        self.state = self.peer.listen("state", STATE)
        self.robot = self.peer.listen("robot_state", STATE)

    def __enter__(self) -> "Talker":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self.peer.close()
        self.agent.terminate()

    @property
    def pid(self) -> int:
        return self.agent.process.pid

    def say(self, text: str) -> float:
        """Send it; the time at which it was on its way."""
        begun = time.monotonic()
        self.peer.send("text_input", text)
        return begun

    def acknowledged_s(self, text: str) -> float:
        """Seconds from the message out to the first sentence in; then the robot is stopped."""
        heard = len(self.sentence.messages)
        begun = self.say(text)
        self.sentence.wait_for(lambda _: True, since=heard)
        taken = self.sentence.times[heard] - begun
        self.stop()
        return taken

    def first_token_s(self) -> float:
        """Seconds to the first token of a long answer, which is then stopped."""
        self.forget()
        heard = len(self.token.messages)
        begun = self.say(STORY)
        self.token.wait_for(lambda _: True, since=heard)
        taken = self.token.times[heard] - begun
        self.stop()
        return taken

    def stopped_s(self) -> float:
        """Seconds from "stop" out to zero velocity in, while the robot drives and a model works."""
        self.forget()
        here = json.loads(self.robot.messages[-1])["room"]
        self.say(f"go to the {random.choice([room for room in ROOMS if room != here])}")
        _wait(self.robot, lambda m: json.loads(m)["velocity"]["linear"] > 0.3)
        heard = len(self.token.messages)
        self.say(STORY)
        self.token.wait_for(lambda _: True, since=heard)
        seen = len(self.robot.messages)
        begun = self.say("stop")
        self.robot.wait_for(_standing, since=seen)
        index = next(i for i in range(seen, 10**9) if _standing(self.robot.messages[i]))
        taken = self.robot.times[index] - begun
        self.stop()
        return taken

    def forget(self) -> None:
        """Have it forget what was said, so that each round is like the first."""
        self.peer.send("command", "reset")
        time.sleep(SETTLE_S)

    def stop(self) -> None:
        """Have it stand still and listen."""
        heard = len(self.sentence.messages)
        self.say("stop")
        self.sentence.wait_for(lambda m: m in STANDING, since=heard)
        self.state.wait_for(lambda m: m == "listening", since=len(self.state.messages) - 1)


def _standing(message: str) -> bool:
    velocity = json.loads(message)["velocity"]
    return abs(velocity["linear"]) < 0.005 and abs(velocity["angular"]) < 0.005


def _wait(heard: Heard, wanted: Callable[[str], bool]) -> None:
    heard.wait_for(wanted, timeout_s=30, since=len(heard.messages))
