"""What is asked of the robot in words that no template has, and what a model may say of it."""

from itertools import chain

import pytest
from support.bodies import BODIES, FACTS
from support.body import FakeBody
from support.conversation import Eloquent, Talk

from edgevox.agent.llm.language_model import Piece
from edgevox.agent.llm.protocol import SAY
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.model_answer import CheckedAnswer
from edgevox.agent.nlu.questions import (
    WorldWords,
    asks,
    asks_whether,
    cued,
    is_about_hearer,
    question_of,
)
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import Call, SkillSet

BOOK = phrasebook(ENGLISH)
NOT_KNOWN = BOOK.say("not_known")
WORLD = {body: WorldWords(skills.values(), BOOK) for body, skills in BODIES.items()}
READINGS = {
    body: Readings(SkillSet(one for one in facts if not one.new_names), ENGLISH)
    for body, facts in FACTS.items()
}
KITCHEN, BEDROOM = (Call("how_far", {"room": room}) for room in ("kitchen", "bedroom"))
ASKED = {
    ("apartment", "how long would a trip to the bedroom take"): BEDROOM,
    ("apartment", "how many minutes would you need to the kitchen?"): KITCHEN,
    ("panda", "which box is the green cube in"): Call("where_is", {"object": "green_cube"}),
    ("panda", "has the red cube been put into a bin?"): Call("where_is", {"object": "red_cube"}),
}


def read(body, text):
    return question_of(READINGS[body].of(text), text, ENGLISH)


@pytest.mark.parametrize(("body", "text"), ASKED)
def test_other_words_for_a_question_are_read_by_what_they_name_and_weigh(body, text):
    assert read(body, text) == ASKED[body, text]


@pytest.mark.parametrize(
    ("body", "text", "call"),
    [
        ("apartment", "tell me, from here, is the bedroom far?", BEDROOM),
        ("apartment", "which of the rooms is the farthest?", Call("nearest_place", {})),
        ("apartment", "do you need charging soon?", Call("battery", {})),
        ("apartment", "is there something standing in front of you?", Call("what_is_ahead", {})),
        ("panda", "the left bin, is it full?", Call("what_is_there", {"target": "left_bin"})),
        ("panda", "can you reach the red cube?", Call("how_far_is_thing", {"object": "red_cube"})),
        ("humanoid", "the speed that you walk at, what is it?", Call("how_fast", {})),
    ],
)
def test_a_question_is_known_by_its_own_words_in_any_order(body, text, call):
    assert cued(text, READINGS[body].lexicon) == call


@pytest.mark.parametrize(
    "text",
    [
        "you did a great job today",
        "your eyes are nice",
        "your path is clear",
        "you are moving well",
    ],
)
def test_a_statement_is_no_question_by_its_words(text):
    assert not any(cued(text, READINGS[body].lexicon) for body in READINGS)


@pytest.mark.parametrize(
    "text",
    [
        "how long does a film in the kitchen run and who sells popcorn",
        "how fast can you be in the kitchen and the office?",
        "you're needed where the kitchen is",
        "the battery is in the kitchen",
        "what can you tell me about the history of Paris",
    ],
)
def test_a_question_with_words_or_names_of_something_else_is_none_by_its_words(text):
    assert cued(text, READINGS["apartment"].lexicon) is None


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(
    "text",
    [
        "how fast is light",
        "how do bees make honey",
        "what is love",
        "how long does it take to boil an egg",
        "where do you live",
        "what does a robot eat",
        "how old are you",
        "who is the president",
        "I was in the kitchen before",
        "the kitchen is nice",
        "could you go to the kitchen?",
        "turn off the lamp",
    ],
)
def test_what_is_no_question_to_this_robot_is_not_read_as_one(body, text):
    assert read(body, text) is None
    assert cued(text, READINGS[body].lexicon) is None


@pytest.mark.parametrize(
    ("text", "whether"),
    [
        ("can you fly", True),
        ("are you able to climb stairs?", True),
        ("can you tell me a joke", False),
        ("can you explain rainbows", False),
        ("how do birds fly", False),
    ],
)
def test_who_asks_about_an_ability_does_not_ask_to_be_told_something(text, whether):
    assert asks_whether(text, ENGLISH) is whether


@pytest.mark.parametrize(
    ("text", "about"),
    [
        ("how old are you", True),
        ("what is your favourite food", True),
        ("do you know how many continents there are", False),
        ("can you tell me how tall Everest is", False),
        ("how many legs has a spider", False),
    ],
)
def test_a_question_is_about_the_robot_only_if_it_is_more_than_a_courtesy(text, about):
    assert is_about_hearer(text, ENGLISH) is about


def test_a_question_opens_with_a_question_word_or_ends_with_a_mark():
    assert asks("where is it", ENGLISH)
    assert asks("the red one?", ENGLISH)
    assert not asks("it is here", ENGLISH)


@pytest.mark.parametrize(
    ("body", "sentence", "claims"),
    [
        ("panda", "The yellow cube is on the table.", True),
        ("panda", "I see the red cube.", True),
        ("panda", "I see 4 things.", True),
        ("panda", "Roses are red.", False),
        ("apartment", "It stands in the kitchen.", True),
        ("apartment", "I am five years old.", True),
        ("apartment", "I like that one.", False),
        ("apartment", "I feel good, thank you.", False),
    ],
)
def test_a_sentence_claims_something_if_it_names_a_thing_a_place_or_a_number(
    body, sentence, claims
):
    assert WORLD[body].claimed_in(sentence) is claims


def test_an_answer_is_held_back_from_its_first_claim_on_however_it_is_cut_into_pieces():
    text = "I am fine. I am in the kitchen. All is well."
    for size in (1, 3, 100):
        checked = CheckedAnswer(WORLD["apartment"].claimed_in)
        pieces = [text[at : at + size] for at in range(0, len(text), size)]
        told = "".join([*chain.from_iterable(map(checked.feed, pieces)), *checked.finish()])

        assert told == "I am fine. "
        assert checked.dropped


def test_an_answer_that_never_began_has_nothing_to_say():
    assert CheckedAnswer(WORLD["apartment"].claimed_in).finish() == []


def test_the_pieces_of_a_sentence_are_told_one_by_one_once_it_has_passed():
    checked = CheckedAnswer(WORLD["apartment"].claimed_in)

    assert [checked.feed(one) for one in ("All ", "is ", "well. It ", "is")] == [
        [], [], ["All ", "is ", "well. "], [],
    ]  # fmt: skip
    assert "".join(checked.finish()) == "It is"


def talk(*pieces):
    body = FakeBody(arrives=True)
    return Talk(body, skills=("navigate_to", "stop"), model=Eloquent(SAY, *pieces))


@pytest.mark.parametrize(
    ("asked", "model", "said"),
    [
        ("how old are you", "I am 5 years old.", NOT_KNOWN),
        ("what do you like", "I like the kitchen best.", NOT_KNOWN),
        ("how are you today", "I feel good, thank you.", NOT_KNOWN),
        ("how many legs has a spider", "It has 8 legs.", "It has 8 legs."),
        ("is the office open today", "Yes, it is.", NOT_KNOWN),
    ],
)
def test_a_model_says_nothing_of_the_robot_and_its_world_that_nobody_told_it(asked, model, said):
    with talk(*model.partition(" ")) as one:
        assert one.say(asked) == said


def test_whether_it_can_do_something_is_not_the_model_s_to_say():
    with talk("Yes, I can climb stairs.") as one:
        assert one.say("can you climb stairs").startswith(BOOK.say("no_ability"))
        assert one.say("can you tell me a story") == NOT_KNOWN


@pytest.mark.parametrize(
    ("code", "sentence", "claims"),
    [
        ("en", "I'm going to bring it.", True),
        ("en", "EdgeVox was built in a lab.", True),
        ("en", "Islands lie in the sea.", False),
        ("de", "Ich habe die Tür geschlossen.", True),
        ("de", "Igel fressen Käfer.", False),
        ("fr", "J'ai fermé la porte.", True),
        ("es", "Mi comida favorita es el arroz.", True),
        ("ja", "私はりんごが好きです。", True),
    ],
)
def test_a_sentence_that_speaks_of_its_speaker_is_a_claim(code, sentence, claims):
    assert WorldWords([], phrasebook(code)).claims_for_itself(sentence) is claims


@pytest.mark.parametrize(("likely", "said"), [(0.9, "Lions are fast."), (0.01, NOT_KNOWN)])
def test_a_model_that_is_not_sure_of_a_word_says_that_it_does_not_know(likely, said):
    with talk("Lions ", Piece("are ", likely), "fast.") as one:
        assert one.say("which animals are fast?") == said
