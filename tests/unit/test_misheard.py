"""What is nearly a command when it is spoken: asked about, never simply done, and never typed."""

import pytest
from dialogue_rig import Walker
from misheard_rig import LETTERS, Spoken

from edgevox.agent.agents import Agent
from edgevox.agent.asking import YES_FROM
from edgevox.agent.near_stop import NearStop
from edgevox.agent.nlu.hearing_prompt import MOST_CHARACTERS, HearingPrompts
from edgevox.agent.nlu.hypotheses import is_contested
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.nlu.near_commands import NearCommands
from edgevox.agent.nlu.sounds import SoundTable, sounds_of
from edgevox.agent.nlu.wordings import wordings
from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.skills import Call
from edgevox.core.commands import Hypothesis, TextInput
from edgevox.core.languages import LANGUAGES
from edgevox.voice.stt.expectation import SHOWN_COMMANDS

ASKED = "Shall I do this? Going to the kitchen."


@pytest.fixture
def rig():
    spoken = Spoken()
    yield spoken
    spoken.talk.close()


def test_a_command_that_is_nearly_heard_is_asked_about_and_done_after_a_yes(rig):
    assert rig.hears("kitchen pleas") == ASKED
    assert rig.body.moves == []

    rig.hears("yes")

    assert rig.body.moves == ["kitchen"]


def test_a_yes_that_was_hardly_heard_is_asked_about_again(rig):
    assert rig.hears("kitchen pleas") == ASKED

    assert rig.hears("yes", confidence=YES_FROM - 0.1) == ASKED
    assert rig.body.moves == []

    rig.hears("yes", confidence=YES_FROM)
    assert rig.body.moves == ["kitchen"]


def test_a_no_counts_however_badly_it_was_heard(rig):
    rig.hears("kitchen pleas")
    rig.hears("no", confidence=0.3)
    rig.hears("yes")

    assert rig.body.moves == []


def test_the_same_words_typed_are_not_repaired(rig):
    assert rig.say("kitchen pleas") != ASKED
    assert rig.body.moves == []


def test_a_command_that_was_heard_clearly_is_done_unasked(rig):
    rig.hears("go to the kitchen", confidence=0.9)

    assert rig.body.moves == ["kitchen"]


def test_a_motion_whose_words_are_not_sure_is_asked_about(rig):
    assert rig.hears("go to the kitchen", confidence=0.5) == ASKED
    assert rig.body.moves == []


def test_a_command_among_what_else_may_have_been_said_is_done_where_the_likeliest_means_nothing(
    rig,
):
    rig.hears("get your employees", others=[("go to the kitchen", 0.3, 0.85)])

    assert rig.body.moves == ["kitchen"]


@pytest.mark.parametrize(
    ("others", "what"),
    [
        ([("go to the kitchen", 0.3, 0.5)], "hardly heard"),
        ([("go to the kitchen", 0.3, 0.85), ("go to the office", 0.1, 0.85)], "contested"),
    ],
)
def test_it_is_asked_about_where_it_was(rig, others, what):
    assert rig.hears("get your employees", others=others) == ASKED, what
    assert rig.body.moves == []


@pytest.mark.parametrize(
    ("said", "others"),
    [
        ("get your employees", [("go to the kitchen", 0.1, 0.85)]),
        ("do not go to the kitchen", [("go to the kitchen", 0.45, 0.9)]),
        ("where are you", [("go to the kitchen", 0.45, 0.9)]),
    ],
)
def test_it_is_neither_done_nor_asked_about_if_it_is_not_likely_or_something_was_understood(
    rig, said, others
):
    assert "Shall I" not in rig.hears(said, others=others)
    assert rig.body.moves == []


def test_a_command_is_asked_about_if_another_is_nearly_as_likely(rig):
    rivals = [("go to the office", 0.3, 0.9)]

    assert rig.hears("go to the kitchen", others=rivals) == ASKED
    assert rig.body.moves == []


def test_the_same_command_in_other_words_contests_nothing(rig):
    rig.hears("go to the kitchen", others=[("drive to the kitchen", 0.4, 0.9)])

    assert rig.body.moves == ["kitchen"]


def test_what_is_left_out_and_what_it_is_then_contest_nothing():
    walker = Agent("walker", "", Walker().skills)
    one_metre = Meaning(walker, (Call("walk_forward", {"distance": 1.0}),), "template")
    far = Meaning(walker, (Call("walk_forward", {"distance": 9.0}),), "template")
    instead = Hypothesis("walk on", 0.4, 0.9)

    same = Meaning(walker, (Call("walk_forward", {}),), "template")
    assert not is_contested(one_metre, [instead], lambda _: same)
    assert is_contested(far, [instead], lambda _: same)


def test_what_moves_nothing_is_answered_however_badly_it_was_heard(rig):
    assert rig.hears("where are you", confidence=0.3) == "I am here."


@pytest.mark.parametrize(
    "chat",
    [
        "I had my lunch in the kitchen",
        "the soup is good",
        "do not go to the kitchen",
        "she works in the office",
    ],
)
def test_chat_is_no_misheard_command(rig, chat):
    assert "Shall I" not in rig.hears(chat)
    assert rig.body.moves == []


def test_a_number_that_was_heard_is_never_lost_by_a_repair():
    near = NearCommands(Walker().skills, phrasebook("en"), LETTERS)

    assert near.nearest("go to the kitchin 5") is None
    assert near.nearest("go to the kitchin").call.arguments == {"room": "kitchen"}


def test_of_two_commands_that_are_as_near_neither_is_meant():
    near = NearCommands(Walker(rooms=("bad", "bed")).skills, phrasebook("en"), LETTERS)

    assert near.nearest("go to the bid") is None


def test_a_place_that_is_learned_is_heard_from_then_on():
    learned = []
    near = NearCommands(
        Walker(rooms=(), learned=lambda: tuple(learned)).skills, phrasebook("en"), LETTERS
    )
    assert near.nearest("go to the librari") is None

    learned.append("library")

    assert near.nearest("go to the librari").call.arguments == {"room": "library"}


def test_sounds_are_compared_by_how_alike_they_are():
    table = SoundTable([sounds_of(one) for one in ("stɑp", "hɔlt", "")])

    same, other, nothing = table.distances(sounds_of("stɑp"), 1.0)
    nearly, _, _ = table.distances(sounds_of("ztɑb"), 1.0)

    assert same == 0.0
    assert 0.0 < nearly < 0.4 < other
    assert nothing == 1.0


def test_what_is_longer_or_shorter_by_more_than_may_be_is_infinitely_far():
    table = SoundTable([sounds_of("stɑp")])

    assert table.distances(sounds_of("stɑpstɑpstɑp"), 0.3)[0] == float("inf")


def test_hearing_is_shown_the_names_that_there_are_now():
    learned = []
    prompt_of = HearingPrompts(Walker(learned=lambda: tuple(learned)).skills)
    assert "Go to the office." in prompt_of("en")
    assert "library" not in prompt_of("en")

    learned.append("library")

    assert "Go to the library." in prompt_of("en")


@pytest.mark.parametrize("code", LANGUAGES)
def test_hearing_listens_again_in_the_languages_in_which_it_is_shown_commands(code):
    shown = HearingPrompts(Walker().skills)(code)

    assert (shown != phrasebook(code).hearing.written) is (code in SHOWN_COMMANDS)


def test_hearing_is_shown_no_more_than_it_reads_however_many_names_there_are():
    rooms = tuple(f"room number {i}" for i in range(500))

    prompt = HearingPrompts(Walker(rooms=rooms).skills)("en")

    assert len(prompt) <= MOST_CHARACTERS
    assert prompt.endswith(phrasebook("en").hearing.written)


def test_a_wording_calls_what_its_words_say():
    skill = Walker().skills["navigate_to"]

    found = {one.sentence: one.call.arguments for one in wordings(skill, phrasebook("en"))}

    assert found["go to the kitchen"] == {"room": "kitchen"}
    assert found["office, please"] == {"room": "office"}


def test_words_that_stand_for_a_number_are_no_wording():
    assert not [*wordings(Walker().skills["navigate_xy"], phrasebook("en"))]


def test_typed_words_are_as_sure_as_they_were(rig):
    rig.talk.submit(TextInput("go to the kitchen"))
    assert rig.talk.wait_idle(60)

    assert rig.body.moves == ["kitchen"]


@pytest.mark.parametrize("heard", ["stob", "Frez a.", "holt"])
def test_a_stop_word_that_is_nearly_heard_stops_what_moves(rig, heard):
    rig.begin("go to the kitchen")

    assert rig.hears(heard) == "Stopped."


@pytest.mark.parametrize("heard", ["stob", "holt"])
def test_the_same_words_stop_nothing_where_nothing_moves(rig, heard):
    assert "Stopped." not in rig.hears(heard)


@pytest.mark.parametrize("heard", ["drive", "we were at the bus stob", "the soup is good"])
def test_what_sounds_otherwise_or_is_longer_stops_nothing(heard):
    assert NearStop("en", LETTERS).find(heard) is None
