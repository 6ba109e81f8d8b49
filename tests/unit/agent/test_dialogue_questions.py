"""What cannot be written as a dialogue of `tests/talk`: own skills, bounds, what a model reads."""

from typing import Annotated

import pytest
from support.body import FakeBody
from support.conversation import Eloquent, Talk

from edgevox.agent.dialogue.memory import MOST_EXCHANGES
from edgevox.agent.llm.protocol import SAY
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import OneOf, SkillPhrases, SkillSet, skill
from edgevox.agent.text.reasons import because
from edgevox.core.commands import TextInput


@pytest.fixture
def talk():
    with Talk() as one:
        yield one


@pytest.mark.parametrize(
    ("code", "asked", "first"),
    [
        ("en", "what can you do?", "sweep a room"),
        ("de", "was kannst du?", "„kehre die hall“"),
        ("es", "¿qué puedes hacer?", "barrer una sala"),
        ("fr", "qu'est-ce que tu sais faire ?", "sweep a room"),
    ],
)
def test_asked_what_it_can_do_it_says_first_what_only_this_robot_can(code, asked, first):
    german = SkillPhrases(templates=("[bitte] kehre [die] {room}", "kehre {room} aus"))
    spanish = SkillPhrases(can="barrer una sala", templates=("barre {room}",))

    @skill(templates=["sweep [the] {room}"], phrases={"de": german, "es": spanish})
    def sweep(goal, room: Annotated[str, OneOf(("hall", "porch"))]):
        """Sweep a room."""

    own = FakeBody().skills("navigate_to", "navigate_xy", "walk_forward", "get_pose")
    with Talk(skills=SkillSet([*own.values(), sweep]), language=code) as talk:
        (answer,) = talk.answers_to(TextInput(asked))

    begin = answer.text.index(first)
    assert begin <= 10
    assert first not in answer.detail, "what is said is not written again"
    said = answer.text.count(";") + answer.detail.count(";") + 1
    assert said == len(own) + 1


def test_asked_why_after_so_much_else_that_it_forgot_the_words_it_names_no_program(talk):
    talk.say("go to the kitchen")
    for _ in range(MOST_EXCHANGES + 1):
        talk.say("what did you hear?")

    assert talk.say("why did you do that?") == phrasebook("en").say("nothing_done")


def test_a_long_sentence_is_quoted_in_part(talk):
    talk.say("blorp " * 100)

    assert len(talk.say("what did you hear?")) < 150


def test_what_is_remembered_is_bounded(talk):
    talk.say("go to the kitchen")
    for number in range(MOST_EXCHANGES):
        talk.say(f"blorp {number}")

    assert talk.say("again") == phrasebook("en").refusal(because("nothing_before"))


def test_a_model_reads_what_it_was_asked_before_and_no_commands():
    with Talk(model=Eloquent(f"{SAY}Ice is light.")) as talk:
        opening = len(talk.conversation.interpreter.chat())
        talk.say("go to the kitchen", "why does ice float", "what did you hear?", "again")

        told = [message.content for message in talk.conversation.interpreter.chat()][opening:]

    assert told == ["why does ice float", f"{SAY}Ice is light."]
