"""Programs move the robot of the apartment: there, back and there again, until it is stopped."""

import threading

import pytest
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet
from edgevox.core.agent_events import GoalChanged, GoalStatus, ProgramChanged
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.robots.facts import known_of
from edgevox.robots.flat.apartment import ApartmentRobot

STEP_S = 0.5


class Watched:
    """The robot in held time, and the rooms in which its drives ended."""

    def __init__(self, robot):
        self.robot, bus = robot, Bus()
        self.rooms, self.statuses = [], []
        self._changed = threading.Condition()
        bus.subscribe(GoalChanged, self._on_goal)
        bus.subscribe(ProgramChanged, lambda event: self.statuses.append(str(event.status)))
        self.talk = Conversation(
            [Agent("robot", "", SkillSet(robot.skills))],
            bus,
            halt=robot.halt,
            known=known_of(robot),
        )
        self.talk.start()

    def say(self, text):
        self.talk.submit(TextInput(text))

    def drive_until(self, rooms):
        """Let time pass until so many drives have ended."""
        with self._changed:
            while len(self.rooms) < rooms:
                self._changed.wait(0.001)
                self.robot.advance(STEP_S)

    def _on_goal(self, event):
        if event.status is GoalStatus.SUCCEEDED:
            with self._changed:
                self.rooms.append(self.robot.state()["room"])
                self._changed.notify_all()


@pytest.fixture
def watched(held):
    one = Watched(held(ApartmentRobot))
    yield one
    one.talk.close()


def test_a_patrol_visits_both_rooms_again_and_again_until_it_is_stopped(watched):
    watched.say("patrol between the kitchen and the office until I say stop")
    watched.drive_until(4)
    assert watched.rooms == ["kitchen", "office", "kitchen", "office"]
    watched.say("stop")
    assert watched.talk.wait_idle(HUNG_S)
    stood = watched.robot.pose()
    watched.robot.advance(10.0)
    now = watched.robot.pose()
    assert (now.x_m, now.y_m) == pytest.approx((stood.x_m, stood.y_m), abs=0.3)
    assert watched.robot.state()["goal"] is None
    assert watched.statuses[-1] == "cancelled"
    assert watched.robot.state()["collisions"] == 0


def test_it_goes_there_and_back_so_many_times(watched):
    home = watched.robot.state()["room"]
    watched.say("go to the office and back twice")
    watched.drive_until(4)
    assert watched.talk.wait_idle(HUNG_S)
    assert watched.rooms == ["office", home, "office", home]
    assert watched.statuses[-1] == "done"
