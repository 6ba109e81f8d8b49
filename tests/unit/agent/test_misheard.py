"""What words sound like and nearly are; `tests/talk/misheard.yaml` has what comes of them."""

import itertools
import math
from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.body import FakeBody
from support.clock import HeldClock
from support.conversation import LETTERS, CertainEncoder

from benchmarks.hearing.people import barista
from edgevox.agent.agents import Agent
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.head import read_head
from edgevox.agent.nlu.hearing.hypotheses import breaks_off, is_contested
from edgevox.agent.nlu.hearing.near import NearCommands, NearStop
from edgevox.agent.nlu.hearing.network import Network, Sentences
from edgevox.agent.nlu.hearing.sounds import SpanTable, sounds_of
from edgevox.agent.nlu.hearing.wordings import MOST_CHARACTERS, HearingPrompts, wordings
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call, OneOf, SkillSet, skill
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.commands import Hypothesis, Way
from edgevox.core.languages import LANGUAGES
from edgevox.voice.stt.speech_to_text import SHOWN_COMMANDS

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


def test_words_that_break_off_where_others_go_on_may_be_half_of_what_was_said():
    walker = Agent("walker", "", skills())
    there = Meaning(walker, (Call("navigate_to", {"room": "kitchen"}),), "template")
    plain = {"Go to the kitchen, please.": there}.get
    said = "Go to the kitchen,"

    assert breaks_off(there, said, [Hypothesis("Go to the kitchen, was sugar.", 0.3, 0.6)], plain)
    for other, share in (
        ("Go to the kitchen, please.", 0.3),
        ("Go to the kitchen.", 0.3),
        ("Go to the chicken with sugar.", 0.3),
        ("Go to the kitchen, was sugar.", 0.05),
    ):
        assert not breaks_off(there, said, [Hypothesis(other, share, 0.6)], plain)
        assert not breaks_off(there, "", [Hypothesis(other, share, 0.6)], plain)


def heard(text, share=1.0):
    return Hypothesis(text, share, 0.85)


def near_commands(some):
    return NearCommands(some, phrasebook("en"), LETTERS)


def test_a_number_that_was_heard_is_never_lost_by_a_repair():
    near = near_commands(skills())

    assert near.nearest([heard("go to the kitchin 5")]) is None
    assert near.nearest([heard("go to the kitchin")]).call.arguments == {"room": "kitchen"}


def test_a_number_of_a_name_is_the_one_that_was_heard():
    near = near_commands(skills(rooms=("bay two", "bay three")))

    assert near.nearest([heard("go to tha bay two")]).call.arguments == {"room": "bay two"}
    assert near.nearest([heard("go to tha bay ten")]) is None


def test_of_two_commands_that_are_as_near_none_is_clear():
    near = near_commands(skills(rooms=("bad", "bed")))

    assert not near.nearest([heard("go to the bid")]).sure


def test_a_command_is_clear_only_if_most_hypotheses_sound_like_it():
    near = near_commands(skills())
    likely, unlikely = heard("go to the kitchin", 0.7), heard("go to the kitchin", 0.3)

    assert near.nearest([likely, heard("gone with the wind", 0.3)]).sure
    assert not near.nearest([heard("gone with the wind", 0.7), unlikely]).sure
    assert near.nearest([heard("gone with the wind", 0.9), heard("go to the kitchin", 0.1)]) is None


def test_only_a_name_says_not_what_to_do():
    near = near_commands(skills())

    assert not near.nearest([heard("go to the kitchen pleas")]).alone
    assert near.nearest([heard("kitchen pleas")]).alone


def test_the_likelier_hypothesis_decides_between_commands_that_sound_alike():
    near = near_commands(skills(rooms=("bad", "bed")))

    found = near.nearest([heard("gou to the bed", 0.8), heard("gou to the bad", 0.2)])

    assert found.call.arguments == {"room": "bed"}


def test_a_place_that_is_learned_is_heard_from_then_on():
    body = FakeBody(rooms=())
    near = near_commands(body.skills("navigate_to"))
    assert near.nearest([heard("go to the librari")]) is None

    body.learned = ("library",)

    assert near.nearest([heard("go to the librari")]).call.arguments == {"room": "library"}


def letters(text):
    return sounds_of(LETTERS(text.replace(" ", ""), "en"))


ORDERS = Sentences(
    "order",
    ("(make|brew) [a] [{size}] {drink} [<extra>]", "a {drink} of {weight} kilograms"),
    {"size": ("small", "large"), "drink": ("latte", "iced latte", "mocha")},
)
RULES = {"extra": "with (milk;[and ]sugar)"}


def test_the_nearest_sentences_come_first_each_meaning_once():
    network = Network([ORDERS], RULES, letters)

    found = network.nearest("brew a smal moka", 0.3, 1.0)

    assert found[0].words == "brew a small mocha"
    assert found[0].values == {("size", "small"), ("drink", "mocha")}
    assert [one.distance for one in found] == sorted(one.distance for one in found)
    assert len({one.meaning for one in found}) == len(found) > 3


def test_a_template_with_a_slot_that_has_no_words_has_no_sentence():
    network = Network([ORDERS], RULES, letters)

    assert not network.nearest("a latte of 3 kilograms", 0.3, 0.1)


@pytest.mark.parametrize("text", ["", "!", "the moon is made of green cheese"])
def test_what_sounds_like_no_sentence_has_no_path(text):
    assert Network([ORDERS], RULES, letters).nearest(text, 0.3, 0.1) == []


def test_a_network_of_nothing_has_no_path():
    assert Network([], {}, letters).nearest("brew a mocha", 1.0, 1.0) == []


def edits(heard, phrase, weight, change):
    """The textbook's edit distance, to hold the table against."""
    row = list(itertools.accumulate((weight(one) for one in phrase), initial=0.0))
    for sound in heard:
        new = [row[0] + weight(sound)]
        for at, one in enumerate(phrase):
            new.append(
                min(
                    row[at + 1] + weight(sound), new[at] + weight(one), row[at] + change(sound, one)
                )
            )
        row = new
    return row[-1]


@given(st.text("ptkaeisʃ", max_size=9), st.lists(st.text("ptkaeisʃ", max_size=6), min_size=1))
def test_the_cost_of_a_phrase_for_a_piece_is_its_edit_distance(said, phrases):
    sounds = [sounds_of(one) for one in phrases]
    whole = sounds_of(said)
    table = SpanTable(sounds)
    alone = SpanTable([])

    spans = table.spans(whole)

    def change(one, other):
        return float(SpanTable([(other,)]).spans((one,))[0, 0, 1])

    for row, phrase in enumerate(sounds):
        for begin in range(len(whole) + 1):
            for end in range(begin, len(whole) + 1):
                if math.isfinite(spans[row, begin, end]):
                    cost = edits(whole[begin:end], phrase, lambda one: alone.weight((one,)), change)
                    assert spans[row, begin, end] == pytest.approx(cost, abs=1e-4)
        assert all(
            spans[row, at, at] == pytest.approx(alone.weight(phrase))
            for at in range(len(whole) + 1)
        )


def test_sounds_are_compared_by_how_alike_they_are():
    table = SpanTable([sounds_of(one) for one in ("stɑp", "hɔlt", "")])

    same, other, nothing = table.distances(sounds_of("stɑp"))
    nearly, _, _ = table.distances(sounds_of("ztɑb"))

    assert same == 0.0
    assert 0.0 < nearly < 0.4 < other
    assert nothing == pytest.approx(1.0)


def test_what_is_much_longer_is_infinitely_far():
    table = SpanTable([sounds_of("stɑp")])

    assert table.distances(sounds_of("stɑp" * 4))[0] == float("inf")


@pytest.mark.parametrize("code", [code for code in LANGUAGES if phrasebook(code).hearing.spaced])
def test_every_sentence_of_the_network_is_a_command(code):
    book, some = phrasebook(code), skills()
    near = NearCommands(some, book, LETTERS)
    recogniser = Recogniser(some, code)
    for wording in (it for one in some.values() for it in [*wordings(one, book)][::9]):
        found = near.nearest([heard(wording.sentence)])
        assert found is None or found.call.skill == wording.call.skill
        if found and not wording.alone:
            assert isinstance(recogniser.recognise(wording.sentence), Understood)


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


def test_hearing_is_shown_every_name_of_a_skill_with_several_in_few_sentences():
    @skill(templates=("bring [me] the {thing} [{how}]",))
    def bring(
        goal,
        thing: Annotated[str, OneOf(("mug", "newspaper", "umbrella"))],
        how: Annotated[str, OneOf(("at once", "slowly", "as usual"))] = "as usual",
    ) -> None:
        """Bring a thing."""

    written = phrasebook("en").hearing.written
    prompt = HearingPrompts(SkillSet([bring]))("en")
    shown = prompt.removesuffix(written)

    assert all(name in shown for name in ("mug", "newspaper", "umbrella", "at once", "slowly"))
    assert "as usual" not in shown
    assert shown.count(".") == 3
    assert HearingPrompts(SkillSet([bring]))("en") == prompt


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


def rates(**nats):
    """Rates texts by the last of these words that is in them; those without any are impossible."""
    asked = []

    def rate(texts):
        asked.extend(texts)
        return [
            max(
                (nats[word] for word in text.lower().strip(".").split() if word in nats),
                default=-99.0,
            )
            for text in texts
        ]

    rate.asked = asked
    return rate


def hardly(text, share=1.0, confidence=0.85):
    return Hypothesis(text, share, confidence)


def test_the_sound_tells_which_of_two_commands_was_said():
    near = near_commands(skills(rooms=("bad", "bed")))

    for said, other in (("bed", "bad"), ("bad", "bed")):
        found = near.nearest([hardly("Go to the bid.")], rates(**{said: -2, other: -9, "bid": -1}))
        assert found.call.arguments == {"room": said}
        assert found.sure
    assert not near.nearest([hardly("Go to the bid.")], rates(bed=-2, bad=-3, bid=-1)).sure


def test_only_the_words_that_differ_are_rated_otherwise():
    near = near_commands(skills())
    rate = rates(kitchen=-1)

    near.nearest([hardly("Please, go to the kitchin!")], rate)

    assert rate.asked[0] == "Please, go to the kitchen!"


def test_what_the_sound_is_far_more_like_is_no_command():
    near = near_commands(skills(rooms=("bad", "bed")))

    assert not near.nearest([hardly("Go to the bid.")], rates(bed=-14, bid=-1)).likely
    assert near.nearest([hardly("Go to the bid.")], rates(bed=-30, bid=-1)) is None


FAR = "room behind the old workshop of the northern wing"


@pytest.mark.parametrize(
    ("instead", "likely"), [("Go to the bid", False), ("Gone to the bid", True)]
)
def test_the_more_words_differ_the_less_likely_a_command_may_be(instead, likely):
    near = near_commands(skills(rooms=(f"bad {FAR}", f"bed {FAR}")))
    several = [hardly(f"{instead} {FAR}.", 0.6), hardly(f"Go to the bed {FAR}.", 0.4)]

    assert near.nearest(several, rates(bed=-7, bid=-1)).likely is likely


def test_words_that_were_heard_well_are_asked_about_at_most():
    near = near_commands(skills(rooms=(f"bad {FAR}", f"bed {FAR}")))
    rate = rates(bed=-2, bid=-1)
    found = near.nearest([hardly(f"Go to the bid {FAR}.", confidence=0.95)], rate)

    assert found.likely
    assert not found.sure
    assert near.nearest([hardly(f"Go to the bid {FAR}.")], rate).sure


def test_a_few_words_that_were_heard_well_are_no_others():
    near = near_commands(skills(rooms=("bad", "bed")))

    first, other = hardly("Go to the bid.", 0.9, 0.95), hardly("Go to the bed.", 0.1)

    assert not near.nearest([first], rates(bed=-2, bid=-1)).likely
    assert not near.nearest([first, other], rates(bed=-2, bid=-1)).likely


@pytest.mark.parametrize(
    ("place", "confidence", "sure"),
    [("", 0.85, True), ("", 0.7, False), (f" {FAR}", 0.7, True), (f" {FAR}", 0.4, False)],
)
def test_words_that_were_hardly_heard_must_be_many(place, confidence, sure):
    near = near_commands(skills(rooms=(f"bad{place}", f"bed{place}")))
    heard_so = hardly(f"Go to the bid{place}.", confidence=confidence)

    assert near.nearest([heard_so], rates(bed=-2, bid=-1)).sure is sure


def test_a_word_that_the_robot_knows_is_no_other_one():
    near = near_commands(skills(rooms=("large office of berta", "long hall")))
    rate = rates(large=-1, long=-1)

    assert not near.nearest([heard("go to the long office of berta")]).sure
    assert not near.nearest([hardly("go to the long office of berta")], rate).sure


def test_a_value_has_no_word_that_was_not_heard():
    near = near_commands(skills(rooms=("old engineering department",)))
    said = "go to the engineering department"

    assert not near.nearest([heard(said)]).sure
    assert not near.nearest([hardly(said)], rates(department=-1)).sure


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("Brew a coffee with some skin milk.", True),
        ("Never brew a coffee with some skin milk.", False),
    ],
)
def test_a_command_among_the_hypotheses_is_asked_about_where_the_words_lack_a_value(
    text: str, asked: bool
) -> None:
    decider, bus, clock = Decider(CertainEncoder(), read_head()), Bus(), HeldClock()
    interpreter = Interpreter([Agent("robot", "", barista())], bus, clock, decider=decider)
    others = (Hypothesis("Brew a coffee with some skim milk.", 0.4, 0.8),)
    turn = Turn(1, bus, clock, lambda: None, way=Way.VOICE, hearing=0.9, others=others)

    meant = interpreter.understand(text, turn)

    assert (meant is not None) is asked
    assert meant is None or (meant.calls[0].arguments["milk"] == "skim milk" and not meant.sure)
