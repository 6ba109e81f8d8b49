"""Whatever way a wish comes in by, the policy is asked; a stop is never refused."""

import threading
from typing import Annotated

import pytest
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.policy import Denied, Guard, Rule
from edgevox.agent.skills import GoalHandle, OneOf, SkillSet, skill
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import AgentEvent, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, Interrupt, Reset, RunSkill, TextInput, Way
from edgevox.core.events import Outcome, Responded, TurnEnded
from edgevox.core.languages import LANGUAGES

QUESTION = "Shall I do this? Driving."
DENIED = "I cannot do that: I am not permitted to do that."
UNSURE = "I cannot do that: somebody has to say yes to that first."
CODES = ("policy_denied", "policy_hours", "policy_place", "policy_nowhere", "policy_area")
CODES += ("policy_distance", "policy_lost", "needs_confirmation", "needs_a_person")
VALUES = {"policy_place": {"place": "kitchen"}, "policy_distance": {"most": "5"}}


class Rig:
    """A conversation with a robot that drives until it is stopped, under a policy."""

    def __init__(self, file):
        self.file = file
        self.driving = threading.Event()
        self.halts, self.said, self.rejected, self.outcomes = [], [], [], []
        bus = Bus()
        bus.subscribe(Responded, lambda event: self.said.append(event.text))
        bus.subscribe(TurnEnded, lambda event: self.outcomes.append(event.outcome))
        bus.subscribe(AgentEvent, self.hear)

        @skill(templates=["drive to [the] {room}"], says="Driving.")
        def drive(goal: GoalHandle, room: Annotated[str, OneOf(("kitchen", "cellar"))]) -> None:
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

        self.guard = Guard(file, bus)
        self.talk = Conversation(
            [Agent("robot", "Be brief.", SkillSet((drive, stop, where)))],
            bus,
            halt=lambda reason: bool(self.halts.append(reason)),
            guard=self.guard,
        )
        self.talk.start()

    def hear(self, event):
        told = as_json(event)
        if told.get("status") == "rejected":
            self.rejected.append((told["way"], told["skill"], told["code"], told["turn"] > 0))

    def submit(self, command):
        """What was said to it."""
        self.talk.submit(command)
        assert self.talk.wait_idle(HUNG_S)
        return self.said[-1]

    def under(self, policy):
        self.file.write_text(policy)


@pytest.fixture
def rig(tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {}")
    one = Rig(file)
    yield one
    one.talk.close()


IN_WORDS = {
    Way.VOICE: Heard("drive to the kitchen", 0.0),
    Way.TYPED: TextInput("drive to the kitchen", Way.TYPED),
    Way.TEXT_INPUT: TextInput("drive to the kitchen"),
    Way.COMMAND: RunSkill("drive", {"room": "kitchen"}),
    Way.CONSOLE_VIEWER: TextInput("drive to the kitchen", Way.CONSOLE_VIEWER),
    Way.CONSOLE_OPERATOR: TextInput("drive to the kitchen", Way.CONSOLE_OPERATOR),
}
OF_PROGRAMS = (Way.ACTION, Way.GOAL_POSE)


def test_every_way_but_velocities_is_one_that_is_tried_here():
    assert {*IN_WORDS, *OF_PROGRAMS, Way.CMD_VEL} == set(Way)


@pytest.mark.parametrize("way", IN_WORDS)
def test_a_sentence_is_refused_by_its_way_aloud_and_as_an_event(rig, way):
    rig.under(f"rules: {{{way}: deny}}")
    assert rig.submit(IN_WORDS[way]) == DENIED
    assert rig.rejected == [(way, "drive", "policy_denied", True)]
    assert rig.guard.refusals == {(way, "policy_denied"): 1}
    assert not rig.driving.is_set()


@pytest.mark.parametrize("way", IN_WORDS)
def test_a_sentence_of_every_other_way_is_done(rig, way):
    others = ", ".join(f"{other}: deny" for other in Way if other is not way)
    rig.under(f"rules: {{{others}}}")
    rig.talk.submit(IN_WORDS[way])
    assert rig.driving.wait(HUNG_S)
    assert rig.guard.refusals == {}


@pytest.mark.parametrize("way", OF_PROGRAMS)
def test_a_program_is_refused_with_the_code_and_nothing_is_said(rig, way):
    rig.under(f"rules: {{{way}: {{drive: deny}}}}")
    for ask in (rig.talk.check_goal, rig.talk.start_goal):
        with pytest.raises(Denied) as denied:
            ask("drive", {"room": "kitchen"}, way=way)
        assert denied.value.reason.code == "policy_denied"
    other = Way.ACTION if way is Way.GOAL_POSE else Way.GOAL_POSE
    rig.talk.start_goal("drive", {"room": "kitchen"}, way=other)
    assert rig.driving.wait(HUNG_S)
    assert rig.said == []


@pytest.mark.parametrize("way", [way for way in IN_WORDS if way.attended])
def test_what_needs_a_yes_is_asked_about_and_a_yes_is_enough(rig, way):
    rig.under("rules: {'*': confirm}")
    assert rig.submit(IN_WORDS[way]) == QUESTION
    assert rig.rejected == []
    assert rig.outcomes == [Outcome.ASKED]
    assert not rig.driving.is_set()
    rig.talk.submit(TextInput("yes", way))
    assert rig.driving.wait(HUNG_S)


def test_the_yes_of_one_who_may_not_ask_for_it_is_not_enough(rig):
    rig.under("rules: {voice: confirm, console_viewer: deny}")
    assert rig.submit(IN_WORDS[Way.VOICE]) == QUESTION
    assert rig.submit(TextInput("yes", Way.CONSOLE_VIEWER)) == DENIED
    assert not rig.driving.is_set()


def test_a_call_by_name_of_somebody_who_could_be_asked_is_refused_as_nobody_asks(rig):
    rig.under("rules: {'*': confirm}")
    form = RunSkill("drive", {"room": "kitchen"}, Way.CONSOLE_OPERATOR)
    assert rig.submit(form) == UNSURE
    assert rig.rejected == [("console_operator", "drive", "needs_confirmation", True)]
    assert not rig.driving.is_set()


@pytest.mark.parametrize("way", OF_PROGRAMS)
def test_where_nobody_can_be_asked_what_needs_a_yes_is_refused(rig, way):
    rig.under("rules: {'*': confirm}")
    with pytest.raises(Denied) as denied:
        rig.talk.start_goal("drive", {"room": "kitchen"}, way=way)
    assert denied.value.reason.code == "needs_a_person"


def test_a_limit_is_refused_with_its_own_reason(rig):
    rig.under("limits: {places: {never: [kitchen]}}")
    said = "I cannot do that: I am not permitted to go there: kitchen."
    assert rig.submit(IN_WORDS[Way.VOICE]) == said
    assert rig.rejected == [("voice", "drive", "policy_place", True)]


def test_what_moves_nothing_has_rules_and_no_limits(rig):
    rig.under("limits: {places: {only: [kitchen]}, hours: [{from: '00:00', to: '00:01'}]}")
    assert rig.submit(TextInput("where are you")) == "Here."
    rig.under("rules: {text_input: {where: deny}}")
    assert rig.submit(TextInput("where are you")) == DENIED


def test_of_several_orders_none_is_done_if_one_is_refused(rig):
    rig.under("limits: {places: {never: [cellar]}}")
    both = "drive to the kitchen and then drive to the cellar"
    assert rig.submit(TextInput(both)).endswith("not permitted to go there: cellar.")
    assert not rig.driving.is_set()


@pytest.mark.parametrize(
    "command",
    [
        TextInput("stop"),
        Heard("stop", 0.0),
        TextInput("stop", Way.CONSOLE_VIEWER),
        Interrupt(),
        Reset(),
        RunSkill("stop", {}),
        TextInput("hold your position"),
    ],
    ids=["text", "voice", "console", "interrupt", "reset", "skill", "sentence"],
)
def test_a_stop_is_never_refused(rig, command):
    rig.talk.start_goal("drive", {"room": "kitchen"})
    assert rig.driving.wait(HUNG_S)
    rig.under("rules: {'*': deny}\nlimits: {hours: [{from: '00:00', to: '00:01'}]}")
    rig.talk.submit(command)
    assert rig.talk.wait_idle(HUNG_S), "the drive is over"
    assert rig.guard.refusals == {}


def test_a_program_may_stop_it_always(rig):
    rig.under("rules: {'*': deny}")
    assert rig.talk.start_goal("stop", {}).wait(HUNG_S)
    assert rig.guard.refusals == {}


def test_a_drive_that_runs_goes_on_when_the_policy_forbids_the_next_one(rig):
    goal = rig.talk.start_goal("drive", {"room": "kitchen"})
    assert rig.driving.wait(HUNG_S)
    rig.under("rules: {'*': deny}")
    with pytest.raises(Denied):
        rig.talk.start_goal("drive", {"room": "cellar"})
    assert not goal.token.cancelled


def test_words_that_ask_for_nothing_are_answered_whatever_the_policy(rig):
    rig.under("rules: {'*': deny}")
    rig.submit(TextInput("good morning"))
    assert rig.guard.refusals == {}


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_reason_is_said_in_every_language(code):
    book = phrasebook(code)
    for name in CODES:
        reason = because(name, **VALUES.get(name, {}))
        said = book.reason(reason)
        assert (said == str(reason)) == (code == "en"), name
        assert "{" not in book.refusal(reason)


def test_the_rules_are_in_the_order_of_their_strictness():
    assert list(Rule) == ["allow", "confirm", "deny"]
