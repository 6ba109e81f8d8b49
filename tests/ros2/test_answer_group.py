"""Several robots hear one utterance, in processes of their own: one answers, also if one dies."""

import contextlib
import json
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from agent_process import Agent
from guards import HUNG_S
from peer import SENSOR, Peer
from std_msgs.msg import String
from waiting import wait_until

SCRIPT = Path(__file__).with_name("hearing_robot.py")
NAMES = ("Rosie", "Max", "Bender")
TRIES = 5
LEVELS_DB = {"Rosie": 12.0, "Max": 25.0, "Bender": 18.0}


class Robot(Agent):
    """A robot's part in the group."""

    def __init__(self, name: str, domain: int) -> None:
        self.name = name
        arguments = (sys.executable, str(SCRIPT), name)
        super().__init__(
            *arguments[1:], domain=domain, stdin=subprocess.PIPE, program=sys.executable
        )

    def tell(self, number: int, **told: object) -> None:
        self.process.stdin.write(json.dumps({"number": number, **told}) + "\n")
        self.process.stdin.flush()

    def answers(self, number: int) -> str:
        """Who answers, as this robot has it."""
        return self.wait_for_line(f"answers {number} ").rpartition(" ")[2]

    def end(self) -> None:
        self.process.send_signal(signal.SIGCONT)
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait(HUNG_S)


@pytest.fixture
def robots(domain) -> Iterator[dict[str, Robot]]:
    started = {name: Robot(name, domain) for name in NAMES}
    for name, one in started.items():
        others = " ".join(sorted(set(NAMES) - {name}))
        one.wait_for_line(f"here {others}")
    yield started
    for one in started.values():
        one.end()


def all_hear(robots: Mapping[str, Robot], number: int) -> None:
    for name, one in robots.items():
        one.tell(number, heard=LEVELS_DB[name])


def words(robots: Mapping[str, Robot], number: int, text: str = "Go to the kitchen.") -> None:
    for one in robots.values():
        one.tell(number, words=text)


def agreed(robots: Mapping[str, Robot], number: int) -> str:
    """Who answers, as all of these robots have it."""
    said = {name: one.answers(number) for name, one in robots.items()}
    found = {name if who == "I" else who for name, who in said.items()}
    assert len(found) == 1, said
    assert list(said.values()).count("I") <= 1, said
    return found.pop()


def test_one_robot_answers_and_it_is_the_one_that_hears_best(robots):
    for number in range(TRIES):  # a machine that holds it up for 0.2 s makes it one that is gone
        all_hear(robots, number)
        words(robots, number)
        if agreed(robots, number) == "Max":
            return
    pytest.fail("the one that hears best never answered")


def test_the_named_robot_answers_however_well_it_hears(robots):
    all_hear(robots, 1)
    words(robots, 1, "Rosie, go to the kitchen.")
    assert agreed(robots, 1) == "Rosie"


def test_when_the_best_is_killed_between_hearing_and_deciding_another_answers(robots):
    all_hear(robots, 1)
    best, others = robots["Max"], {name: one for name, one in robots.items() if name != "Max"}
    words(others, 1)
    best.process.kill()
    assert agreed(others, 1) in others


def test_one_that_was_frozen_keeps_silent_when_it_goes_on(robots):
    all_hear(robots, 1)
    best, others = robots["Max"], {name: one for name, one in robots.items() if name != "Max"}
    best.process.send_signal(signal.SIGSTOP)
    words(robots, 1)
    assert agreed(others, 1) in others
    best.process.send_signal(signal.SIGCONT)
    assert agreed(robots, 1) in others


def test_an_agent_is_one_of_its_group(domain):
    flags = ("--ros2", "--agent-namespace=/robot1", "--frame-prefix=robot1/", "--llm=none")
    group = ("--answer-group=hall", "--spoken-name=Rosie", "--audio-in=none", "--audio-out=none")
    agent = Agent("robot-apartment", *flags, *group, domain=domain)
    other = Robot("Max", domain)
    try:
        other.wait_for_line("here Rosie")
        since = len(other.lines)
        agent.leave()
        other.wait_for_line("here", since=since)
    finally:
        agent.terminate()
        other.end()


def test_what_a_stranger_sends_is_refused_and_harms_nobody(robots, domain):
    stranger = Peer(domain, "/")
    try:
        publisher = stranger.node.create_publisher(String, "/hearers", SENSOR)
        wait_until(lambda: publisher.get_subscription_count() == len(NAMES), "the robots")
        for text in ("{", "[]", "x" * 5000, json.dumps({"id": "me", "answers": "all"})):
            publisher.publish(String(data=text))
        all_hear(robots, 1)
        words(robots, 1)
        assert agreed(robots, 1) in robots
    finally:
        stranger.close()
