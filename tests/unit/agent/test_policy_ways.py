"""Whatever way a wish comes in by, the policy is asked; a stop is never refused."""

import pytest
from guards import HUNG_S
from support.body import FakeBody
from support.conversation import Talk

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.policy import Denied, Rule
from edgevox.agent.text.reasons import because
from edgevox.core.commands import Heard, Interrupt, Reset, RunSkill, TextInput, Way
from edgevox.core.events import Outcome
from edgevox.core.languages import LANGUAGES

QUESTION = "Shall I go to the kitchen?"
SKILLS = ("navigate_to", "stop", "get_pose")
DRIVE = ("navigate_to", {"room": "kitchen"})
DENIED = "I cannot do that: I am not permitted to do that."
UNSURE = "I cannot do that: somebody has to say yes to that first."
UNKNOWN_VOICE = "I cannot do that: I only do that for people whose voice I know."
CODES = (
    "policy_denied",
    "policy_guest",
    "policy_hours",
    "policy_place",
    "policy_nowhere",
    "policy_area",
)
CODES += ("policy_distance", "policy_lost", "needs_confirmation", "needs_a_person")
VALUES = {"policy_place": {"place": "kitchen"}, "policy_distance": {"most": "5"}}


class Rig(Talk):
    """A conversation with a robot that drives until it is stopped, under a policy."""

    def __init__(self, file):
        super().__init__(FakeBody(rooms=("kitchen", "cellar")), skills=SKILLS, policy=file)
        self._file, self.start_goal = file, self.conversation.start_goal

    @property
    def rejected(self):
        told = [one for one in self.told("skill_goal") if one["status"] == "rejected"]
        return [(one["way"], one["skill"], one["code"], one["turn"] > 0) for one in told]

    def submit(self, command):
        """The first that is said to it."""
        return self.answers_to(command)[0].text

    def drives(self, command):
        """Whether it begins to drive."""
        self.conversation.submit(command)
        self.body.starts()

    def under(self, policy):
        self._file.write_text(policy)


@pytest.fixture
def rig(tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {}")
    with Rig(file) as one:
        yield one


IN_WORDS = {
    Way.VOICE: Heard("go to the kitchen", 0.0),
    Way.TYPED: TextInput("go to the kitchen", Way.TYPED),
    Way.TEXT_INPUT: TextInput("go to the kitchen"),
    Way.COMMAND: RunSkill(*DRIVE),
    Way.CONSOLE_VIEWER: TextInput("go to the kitchen", Way.CONSOLE_VIEWER),
    Way.CONSOLE_OPERATOR: TextInput("go to the kitchen", Way.CONSOLE_OPERATOR),
}
GUEST = Heard("go to the kitchen", 0.0, way=Way.VOICE_GUEST)
OF_PROGRAMS = (Way.ACTION, Way.GOAL_POSE)


def test_every_way_but_velocities_is_one_that_is_tried_here():
    assert {*IN_WORDS, GUEST.way, *OF_PROGRAMS, Way.CMD_VEL} == set(Way)


@pytest.mark.parametrize("way", IN_WORDS)
def test_a_sentence_is_refused_by_its_way_aloud_and_as_an_event(rig, way):
    rig.under(f"rules: {{{way}: deny}}")
    assert rig.submit(IN_WORDS[way]) == DENIED
    assert rig.rejected == [(way, "navigate_to", "policy_denied", True)]
    assert rig.guard.refusals == {(way, "policy_denied"): 1}
    assert rig.body.sent == []


@pytest.mark.parametrize("way", IN_WORDS)
def test_a_sentence_of_every_other_way_is_done(rig, way):
    others = ", ".join(f"{other}: deny" for other in Way if other is not way)
    rig.under(f"rules: {{{others}}}")
    rig.drives(IN_WORDS[way])
    assert rig.guard.refusals == {}


def test_a_guest_is_told_that_only_known_voices_may_ask_for_it(rig):
    rig.under("rules: {voice_guest: {navigate_to: deny}}")
    assert rig.submit(GUEST) == UNKNOWN_VOICE
    assert rig.rejected == [("voice_guest", "navigate_to", "policy_guest", True)]
    rig.drives(IN_WORDS[Way.VOICE])


@pytest.mark.parametrize(
    "rules", ["voice: deny", "voice: deny, voice_guest: allow", "'*': deny, voice_guest: {}"]
)
def test_a_guest_may_never_do_more_than_a_known_voice(rig, rules):
    rig.under(f"rules: {{{rules}}}")
    assert rig.submit(GUEST) == DENIED


def test_without_rules_for_guests_a_guest_is_as_any_voice(rig):
    rig.under("rules: {'*': {navigate_to: deny}, voice: {navigate_to: allow}}")
    rig.drives(GUEST)


def test_a_guests_yes_does_not_answer_for_a_known_voice(rig):
    rig.under("rules: {voice: confirm, voice_guest: deny}")
    assert rig.submit(IN_WORDS[Way.VOICE]) == QUESTION
    assert rig.submit(TextInput("yes", Way.VOICE_GUEST)) == UNKNOWN_VOICE
    assert rig.body.sent == []


@pytest.mark.parametrize("way", OF_PROGRAMS)
def test_a_program_is_refused_with_the_code_and_nothing_is_said(rig, way):
    rig.under(f"rules: {{{way}: {{navigate_to: deny}}}}")
    for ask in (rig.conversation.check_goal, rig.start_goal):
        with pytest.raises(Denied) as denied:
            ask(*DRIVE, way=way)
        assert denied.value.reason.code == "policy_denied"
    other = Way.ACTION if way is Way.GOAL_POSE else Way.GOAL_POSE
    rig.start_goal(*DRIVE, way=other)
    rig.body.starts()
    assert rig.said == []


@pytest.mark.parametrize("way", [way for way in IN_WORDS if way.attended])
def test_what_needs_a_yes_is_asked_about_and_a_yes_is_enough(rig, way):
    rig.under("rules: {'*': confirm}")
    assert rig.submit(IN_WORDS[way]) == QUESTION
    assert rig.rejected == []
    assert rig.outcomes == [Outcome.ASKED]
    assert rig.body.sent == []
    rig.drives(TextInput("yes", way))


def test_the_yes_of_one_who_may_not_ask_for_it_is_not_enough(rig):
    rig.under("rules: {voice: confirm, console_viewer: deny}")
    assert rig.submit(IN_WORDS[Way.VOICE]) == QUESTION
    assert rig.submit(TextInput("yes", Way.CONSOLE_VIEWER)) == DENIED
    assert rig.body.sent == []


def test_a_call_by_name_of_somebody_who_could_be_asked_is_refused_as_nobody_asks(rig):
    rig.under("rules: {'*': confirm}")
    form = RunSkill(*DRIVE, Way.CONSOLE_OPERATOR)
    assert rig.submit(form) == UNSURE
    assert rig.rejected == [("console_operator", "navigate_to", "needs_confirmation", True)]
    assert rig.body.sent == []


@pytest.mark.parametrize("way", OF_PROGRAMS)
def test_where_nobody_can_be_asked_what_needs_a_yes_is_refused(rig, way):
    rig.under("rules: {'*': confirm}")
    with pytest.raises(Denied) as denied:
        rig.start_goal(*DRIVE, way=way)
    assert denied.value.reason.code == "needs_a_person"


def test_a_limit_is_refused_with_its_own_reason(rig):
    rig.under("limits: {places: {never: [kitchen]}}")
    said = "I cannot do that: I am not permitted to go there: kitchen."
    assert rig.submit(IN_WORDS[Way.VOICE]) == said
    assert rig.rejected == [("voice", "navigate_to", "policy_place", True)]


def test_what_moves_nothing_has_rules_and_no_limits(rig):
    rig.under("limits: {places: {only: [kitchen]}, hours: [{from: '00:00', to: '00:01'}]}")
    assert rig.submit(TextInput("where are you")) == "I am at 1.2."
    rig.under("rules: {text_input: {get_pose: deny}}")
    assert rig.submit(TextInput("where are you")) == DENIED


def test_of_several_orders_none_is_done_if_one_is_refused(rig):
    rig.under("limits: {places: {never: [cellar]}}")
    both = "go to the kitchen and then go to the cellar"
    assert rig.submit(TextInput(both)).endswith("not permitted to go there: cellar.")
    assert rig.body.sent == []


@pytest.mark.parametrize(
    "command",
    [
        TextInput("stop"),
        Heard("stop", 0.0),
        Heard("stop", 0.0, way=Way.VOICE_GUEST),
        TextInput("stop", Way.CONSOLE_VIEWER),
        Interrupt(),
        Reset(),
        RunSkill("stop", {}),
        TextInput("hold your position"),
    ],
    ids=["text", "voice", "guest", "console", "interrupt", "reset", "skill", "sentence"],
)
def test_a_stop_is_never_refused(rig, command):
    rig.start_goal(*DRIVE)
    rig.body.starts()
    rig.under("rules: {'*': deny}\nlimits: {hours: [{from: '00:00', to: '00:01'}]}")
    rig.conversation.submit(command)
    rig.settle()  # the drive is over
    assert rig.guard.refusals == {}


def test_a_program_may_stop_it_always(rig):
    rig.under("rules: {'*': deny}")
    assert rig.start_goal("stop", {}).wait(HUNG_S)
    assert rig.guard.refusals == {}


def test_a_drive_that_runs_goes_on_when_the_policy_forbids_the_next_one(rig):
    goal = rig.start_goal(*DRIVE)
    rig.body.starts()
    rig.under("rules: {'*': deny}")
    with pytest.raises(Denied):
        rig.start_goal("navigate_to", {"room": "cellar"})
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
    assert list(Rule) == ["allow", "countdown", "confirm", "deny"]
