"""What words sound like and nearly are; `tests/talk/misheard.yaml` has what comes of them."""

import pytest
from support.body import FakeBody
from support.conversation import LETTERS

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.hearing.hypotheses import is_contested
from edgevox.agent.nlu.hearing.near import NearCommands, NearStop
from edgevox.agent.nlu.hearing.prompt import MOST_CHARACTERS, HearingPrompts
from edgevox.agent.nlu.hearing.sounds import SoundTable, sounds_of
from edgevox.agent.nlu.hearing.wordings import wordings
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call
from edgevox.core.commands import Hypothesis
from edgevox.core.languages import LANGUAGES
from edgevox.voice.stt.plausible import SHOWN_COMMANDS

NAMES = ("navigate_to", "navigate_xy", "walk_forward", "get_pose")


def skills(**more):
    return FakeBody(**more).skills(*NAMES)


def test_what_is_left_out_and_what_it_is_then_contest_nothing():
    walker = Agent("walker", "", skills())
    one_metre = Meaning(walker, (Call("walk_forward", {"distance": 1.0}),), "template")
    far = Meaning(walker, (Call("walk_forward", {"distance": 9.0}),), "template")
    instead = Hypothesis("walk on", 0.4, 0.9)

    same = Meaning(walker, (Call("walk_forward", {}),), "template")
    assert not is_contested(one_metre, [instead], lambda _: same)
    assert is_contested(far, [instead], lambda _: same)


def test_a_number_that_was_heard_is_never_lost_by_a_repair():
    near = NearCommands(skills(), phrasebook("en"), LETTERS)

    assert near.nearest("go to the kitchin 5") is None
    assert near.nearest("go to the kitchin").call.arguments == {"room": "kitchen"}


def test_of_two_commands_that_are_as_near_neither_is_meant():
    near = NearCommands(skills(rooms=("bad", "bed")), phrasebook("en"), LETTERS)

    assert near.nearest("go to the bid") is None


def test_a_place_that_is_learned_is_heard_from_then_on():
    body = FakeBody(rooms=())
    near = NearCommands(body.skills("navigate_to"), phrasebook("en"), LETTERS)
    assert near.nearest("go to the librari") is None

    body.learned = ("library",)

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
    body = FakeBody()
    prompt_of = HearingPrompts(body.skills(*NAMES))
    assert "Go to the office." in prompt_of("en")
    assert "library" not in prompt_of("en")

    body.learned = ("library",)

    assert "Go to the library." in prompt_of("en")


@pytest.mark.parametrize("code", LANGUAGES)
def test_hearing_listens_again_in_the_languages_in_which_it_is_shown_commands(code):
    shown = HearingPrompts(skills())(code)

    assert (shown != phrasebook(code).hearing.written) is (code in SHOWN_COMMANDS)


def test_hearing_is_shown_no_more_than_it_reads_however_many_names_there_are():
    rooms = tuple(f"room number {i}" for i in range(500))

    prompt = HearingPrompts(skills(rooms=rooms))("en")

    assert len(prompt) <= MOST_CHARACTERS
    assert prompt.endswith(phrasebook("en").hearing.written)


def test_a_wording_calls_what_its_words_say():
    skill = skills()["navigate_to"]

    found = {one.sentence: one.call.arguments for one in wordings(skill, phrasebook("en"))}

    assert found["go to the kitchen"] == {"room": "kitchen"}
    assert found["office, please"] == {"room": "office"}


def test_words_that_stand_for_a_number_are_no_wording():
    assert not [*wordings(skills()["navigate_xy"], phrasebook("en"))]


@pytest.mark.parametrize("heard", ["drive", "we were at the bus stob", "the soup is good"])
def test_what_sounds_otherwise_or_is_longer_stops_nothing(heard):
    assert NearStop("en", LETTERS).find(heard) is None
