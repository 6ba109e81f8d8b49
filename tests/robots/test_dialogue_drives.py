"""What refers to the last drive, with a robot in the apartment whose time the test holds."""

import math
import threading
import time
from collections.abc import Iterator

import pytest
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.known import Known
from edgevox.agent.skills import SkillSet
from edgevox.core.agent_events import GoalChanged
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded

NEAR_M = 0.15
STEP_S = 0.2


class Drive:
    """A person who speaks to a robot, and lets time pass only while it has something to do."""

    def __init__(self, robot):
        self.robot, self.bus, self.answers = robot, Bus(), []
        self.reports, self.news = 0, threading.Condition()
        self.bus.subscribe(Responded, self._answered)
        self.bus.subscribe(GoalChanged, self._changed)
        agent = Agent("robot", "", SkillSet(robot.skills))
        self.talk = Conversation([agent], self.bus, halt=robot.halt, known=Known(pose=robot.pose))
        self.talk.start()

    def say(self, text):
        """Say it; no time passes in the world until the robot has answered."""
        answered = len(self.answers) + 1
        self.talk.submit(TextInput(text))
        with self.news:
            assert self.news.wait_for(lambda: len(self.answers) >= answered, HUNG_S)
        return self.answers[answered - 1]

    def arrive(self):
        """Let time pass until it is over."""
        self.until(lambda: self.talk.wait_idle(0.0))

    def until(self, true):
        """Let time pass until this is true; a drive that is answered may not have begun yet."""
        deadline_s = time.monotonic() + HUNG_S
        while not true():
            assert time.monotonic() < deadline_s
            self.robot.advance(STEP_S)

    def report(self):
        """Wait until it has said how far it is, while the world stands still."""
        with self.news:
            known = self.reports
            assert self.news.wait_for(lambda: self.reports > known, HUNG_S)

    def _answered(self, event):
        with self.news:
            self.answers.append(event.text)
            self.news.notify_all()

    def _changed(self, event):
        with self.news:
            self.reports += event.feedback is not None
            self.news.notify_all()

    def away_m(self, pose):
        here = self.robot.pose()
        return math.hypot(here.x_m - pose.x_m, here.y_m - pose.y_m)


@pytest.fixture
def drive(held_robot) -> Iterator[Drive]:
    one = Drive(held_robot)
    yield one
    one.talk.close()


def test_go_back_drives_to_where_the_last_drive_began(drive):
    start = drive.robot.pose()
    drive.say("Go to the kitchen.")
    drive.arrive()
    assert drive.away_m(start) > 1.0

    drive.say("Go back.")
    drive.arrive()

    assert drive.away_m(start) < NEAR_M


def test_go_back_turns_round_on_the_way(drive):
    start = drive.robot.pose()
    drive.say("Go to the office.")
    drive.until(lambda: drive.away_m(start) > 1.0)

    drive.say("Go back.")
    drive.arrive()

    assert drive.away_m(start) < NEAR_M


def test_a_question_on_the_way_is_answered_from_the_drive_and_does_not_disturb_it(drive):
    start = drive.robot.pose()
    drive.say("Go to the kitchen.")
    drive.until(lambda: drive.away_m(start) > 1.0)
    drive.report()
    goal, here = drive.robot.state()["goal"], drive.robot.pose()

    doing = drive.say("What are you doing?")
    why = drive.say("Why did you go there?")

    assert doing.startswith("Going to the kitchen.")
    assert "percent of that is done" in doing
    assert why == "Because I heard: “Go to the kitchen”. That is a plain command."
    assert drive.robot.pose() == here
    assert drive.robot.state()["goal"] == goal
    drive.arrive()
    assert drive.answers[-1] == "I am in the kitchen."


def test_this_room_too_drives_on_and_a_stop_ends_all_repeating(drive):
    drive.say("Go to the kitchen.")
    drive.arrive()
    start = drive.robot.pose()
    assert drive.say("And the office too.") == "Going to the office."
    drive.until(lambda: drive.away_m(start) > 0.5)

    drive.say("Stop!")
    drive.until(lambda: not drive.robot.velocity().linear_m_s)
    drive.arrive()  # either is first: it stands, its goal has ended
    here = drive.robot.pose()

    assert "stopped" in drive.say("Again.")
    drive.robot.advance(1.0)
    assert drive.away_m(here) == 0.0
