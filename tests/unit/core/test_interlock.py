"""While the interlock is engaged nothing moves the body, and everything else works."""

import phrases
import pytest
from guards import HUNG_S
from support.conversation import drives

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.core.agent_events import GoalStatus
from edgevox.core.commands import Interrupt, RunSkill
from edgevox.core.languages import LANGUAGES
from edgevox.core.motion.interlock import Holder
from edgevox.ros2.presence import NOT_IN_CHARGE

REFUSED = phrases.refused("other_agent")
DRIVE = ("navigate_to", {"room": "kitchen"})


@pytest.fixture
def talk():
    with drives() as one:
        yield one


def test_a_sentence_that_moves_is_refused_with_the_reason_and_the_others_are_answered(talk):
    talk.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    assert talk.say("go to the kitchen") == REFUSED
    assert talk.say("where are you") == "I am at 1.2."
    assert talk.say("hold your position") == "Stopping."
    assert talk.body.sent == []


def test_a_program_and_a_command_are_refused_too(talk):
    talk.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    for ask in (talk.conversation.check_goal, talk.conversation.start_goal):
        with pytest.raises(SkillFailed, check=phrases.because("other_agent")):
            ask(*DRIVE)
    talk.conversation.check_goal("stop", {})
    talk.conversation.check_goal("get_pose", {})
    assert [one.text for one in talk.answers_to(RunSkill(*DRIVE))] == [REFUSED]


def test_what_moves_when_it_is_engaged_ends_and_that_is_said_once(talk):
    talk.body.drive_on()
    goal = talk.conversation.start_goal(*DRIVE)
    talk.body.starts()
    talk.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    talk.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    assert goal.wait(HUNG_S)
    assert (goal.status, goal.error) == (GoalStatus.CANCELLED, str(NOT_IN_CHARGE))
    talk.settle()
    assert talk.said == [phrases.failed("other_agent")]


def test_a_stop_word_and_an_interrupt_halt_the_body_all_the_same(talk):
    halts = []
    talk.body.on_halt = lambda: halts.append(1)
    talk.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    halts.clear()
    assert talk.say("stop") == phrases.said("standing")
    talk.conversation.submit(Interrupt())
    assert len(halts) == 2


def test_released_it_moves_when_it_is_asked_to_and_not_by_itself(talk):
    talk.interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
    talk.say("go to the kitchen")
    talk.interlock.release(Holder.PRESENCE)
    assert talk.body.sent == []
    talk.begin("go to the kitchen")


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_reason_is_said_in_every_language(code):
    reason = phrasebook(code).reason(NOT_IN_CHARGE)
    assert (reason == str(NOT_IN_CHARGE)) == (code == "en")
    assert reason.rstrip(".") in phrasebook(code).refusal(NOT_IN_CHARGE)
