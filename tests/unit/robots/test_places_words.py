"""Words that are learned while a robot runs: templates and checks know them."""

from typing import Annotated

import phrases
import pytest

from edgevox.agent.nlu.templates import Recogniser, RefusedCommand, Understood
from edgevox.agent.skills import Call, SkillSet, skill
from edgevox.agent.skills.skill import OneOf
from edgevox.core.errors import InvalidValue


class Learner:
    """A skill whose words a test adds to."""

    def __init__(self, *fixed: str) -> None:
        self.learned: tuple[str, ...] = ()
        rooms = OneOf(fixed, {}, lambda: self.learned)

        @skill(templates=["go to [the] {room}"])
        def go(goal, room: Annotated[str, rooms]):
            """Drive to a room."""

        self.skills = SkillSet([go])


@pytest.fixture
def learner():
    return Learner("kitchen")


def test_a_word_is_understood_from_the_sentence_after_it_was_learned(learner):
    recogniser = Recogniser(learner.skills)
    assert isinstance(recogniser.recognise("go to the charger"), RefusedCommand)

    learner.learned = ("charger",)
    assert recogniser.recognise("go to the charger") == Understood(
        (Call("go", {"room": "charger"}),)
    )

    learner.learned = ()
    assert isinstance(recogniser.recognise("go to the charger"), RefusedCommand)
    assert isinstance(recogniser.recognise("go to the kitchen"), Understood)


@pytest.mark.parametrize("said", ["go to dock two", "go to dock 2", "Go to the Dock 2."])
@pytest.mark.parametrize("name", ["dock two", "dock 2"])
def test_a_name_with_a_number_is_understood_however_it_is_written(learner, said, name):
    learner.learned = (name,)

    assert Recogniser(learner.skills).recognise(said) == Understood((Call("go", {"room": name}),))


@pytest.mark.parametrize(
    ("said", "meant"),
    [("go to the chargr", "charger"), ("go to shelf b", None), ("go to shelf a", "shelf a")],
)
def test_a_misheard_name_is_corrected_but_never_to_one_with_another_word(learner, said, meant):
    learner.learned = ("charger", "shelf a")

    found = Recogniser(learner.skills).recognise(said)

    assert (
        found == Understood((Call("go", {"room": meant}),), unsure=meant == "charger")
        if meant
        else isinstance(found, RefusedCommand)
    )


def test_an_argument_takes_what_was_learned_and_no_longer_what_was_forgotten(learner):
    go = learner.skills["go"]
    learner.learned = ("charger",)
    assert go.validate({"room": "The Charger"}) == {"room": "charger"}
    assert go.schema["properties"]["room"]["enum"] == ["kitchen", "charger"]

    learner.learned = ()
    with pytest.raises(InvalidValue, match="got 'charger', expected 'kitchen'"):
        go.validate({"room": "charger"})


def test_a_skill_without_a_word_to_choose_is_refused_until_it_has_one():
    learner = Learner()
    recogniser = Recogniser(learner.skills)
    assert recogniser.recognise("go to the charger") == RefusedCommand(
        phrases.said("no_words", argument="room")
    )
    with pytest.raises(InvalidValue, match="expected a word that was learned before"):
        learner.skills["go"].validate({"room": "charger"})

    learner.learned = ("charger",)
    assert isinstance(recogniser.recognise("go to the charger"), Understood)


def test_what_is_said_for_a_word_may_change_as_well_as_the_words():
    aliases = {"fridge": "kitchen"}
    rooms = OneOf(("kitchen",), aliases)

    @skill(templates=["go to [the] {room}"])
    def navigate_to(goal, room: Annotated[str, rooms]):
        """Drive to a room."""

    recogniser = Recogniser(SkillSet([navigate_to]))
    assert not isinstance(recogniser.recognise("go to the cooker"), Understood)
    aliases["cooker"] = "kitchen"

    assert recogniser.recognise("go to the cooker") == Understood(
        (Call("navigate_to", {"room": "kitchen"}),)
    )
