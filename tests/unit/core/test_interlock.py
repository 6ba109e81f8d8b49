"""While the interlock is engaged nothing moves the body, and everything else works."""

import threading

import phrases
import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import GoalHandle, SkillFailed, SkillSet, skill
from edgevox.core.agent_events import GoalStatus
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, RunSkill, TextInput
from edgevox.core.events import Responded
from edgevox.core.languages import LANGUAGES
from edgevox.core.motion.interlock import Holder, Interlock
from edgevox.ros2.presence import NOT_IN_CHARGE

WAIT_S = 60.0
REFUSED = phrases.refused("other_agent")


class Rig:
    """A conversation with a robot that drives until it is stopped."""

    def __init__(self) -> None:
        self.interlock = Interlock()
        self.driving = threading.Event()
        self.halts: list[str] = []
        self.said: list[str] = []
        bus = Bus()
        bus.subscribe(Responded, lambda event: self.said.append(event.text))

        @skill(templates=["drive"], says="Driving.")
        def drive(goal: GoalHandle) -> None:
            """Drive until stopped."""
            self.driving.set()
            goal.token.wait()
            goal.token.check()

        @skill(templates=["hold your position"], says="Stopping.")
        def stop(goal: GoalHandle) -> None:
            """Stand still."""

        @skill(templates=["where are you"], done="Here.", moves=False)
        def where(goal: GoalHandle) -> None:
            """Say where it is."""

        self.talk = Conversation(
            [Agent("robot", "Be brief.", SkillSet((drive, stop, where)))],
            bus,
            halt=lambda reason: bool(self.halts.append(reason)),
            interlock=self.interlock,
        )
        self.talk.start()

    def say(self, text: str) -> str:
        self.talk.submit(TextInput(text))
        assert self.talk.wait_idle(WAIT_S)
        return self.said[-1]


@pytest.fixture
def rig():
    one = Rig()
    yield one
    one.talk.close()


def test_a_sentence_that_moves_is_refused_with_the_reason_and_the_others_are_answered(rig):
    rig.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    assert rig.say("drive") == REFUSED
    assert rig.say("where are you") == "Here."
    assert rig.say("hold your position") == "Stopping."
    assert not rig.driving.is_set()


def test_a_program_and_a_command_are_refused_too(rig):
    rig.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    for ask in (rig.talk.check_goal, rig.talk.start_goal):
        with pytest.raises(SkillFailed, check=phrases.because("other_agent")):
            ask("drive", {})
    rig.talk.check_goal("stop", {})
    rig.talk.check_goal("where", {})
    rig.talk.submit(RunSkill("drive", {}))
    assert rig.talk.wait_idle(WAIT_S)
    assert rig.said == [REFUSED]


def test_what_moves_when_it_is_engaged_ends_and_that_is_said_once(rig):
    goal = rig.talk.start_goal("drive", {})
    assert rig.driving.wait(WAIT_S)
    rig.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    rig.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    assert goal.wait(WAIT_S)
    assert (goal.status, goal.error) == (GoalStatus.CANCELLED, str(NOT_IN_CHARGE))
    assert rig.talk.wait_idle(WAIT_S)
    assert rig.said == [phrases.failed("other_agent")]


def test_a_stop_word_and_an_interrupt_halt_the_body_all_the_same(rig):
    rig.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    assert rig.say("stop") == phrases.said("standing")
    rig.talk.submit(Interrupt())
    assert len(rig.halts) == 2


def test_released_it_moves_when_it_is_asked_to_and_not_by_itself(rig):
    rig.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    rig.say("drive")
    rig.interlock.release(Holder.PRESENCE)
    assert not rig.driving.is_set()
    rig.talk.submit(TextInput("drive"))
    assert rig.driving.wait(WAIT_S)


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_reason_is_said_in_every_language(code):
    reason = phrasebook(code).reason(NOT_IN_CHARGE)
    assert (reason == str(NOT_IN_CHARGE)) == (code == "en")
    assert reason.rstrip(".") in phrasebook(code).refusal(NOT_IN_CHARGE)
