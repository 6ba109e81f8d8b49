from pathlib import Path
from typing import Annotated

import pytest
import yaml
from phrasebook_bodies import BODIES

from edgevox.agent.nlu.templates import Recogniser, RefusedCommand, Understood
from edgevox.agent.safety import SafetyWords
from edgevox.agent.skills import Call, OneOf, SkillSet, skill
from edgevox.core.languages import LANGUAGES

COMMANDS = yaml.safe_load(Path(__file__).with_name("phrasebook_commands.yaml").read_text("utf-8"))
PLAIN = [
    (code, body, sentence, calls)
    for code, bodies in COMMANDS.items()
    for body in BODIES
    for sentence, calls in bodies[body].items()
]
REFUSED = [
    (code, body, sentence, word)
    for code, bodies in COMMANDS.items()
    for sentence, refusal in bodies["refused"].items()
    for body, word in refusal.items()
]


@pytest.fixture(scope="module")
def recognisers():
    return {(code, body): Recogniser(BODIES[body], code) for code in LANGUAGES for body in BODIES}


@pytest.mark.parametrize(("code", "body", "sentence", "calls"), PLAIN)
def test_a_plain_command_is_understood_in_its_language(recognisers, code, body, sentence, calls):
    found = recognisers[code, body].recognise(sentence)

    assert isinstance(found, Understood)
    assert " + ".join(_written(call) for call in found.calls) == calls
    for call in found.calls:
        BODIES[body][call.skill].validate(call.arguments)


@pytest.mark.parametrize(("code", "body", "sentence", "calls"), PLAIN)
def test_a_plain_command_is_no_stop_word_unless_it_asks_to_stop(code, body, sentence, calls):
    assert SafetyWords(code).find(sentence) is None or calls == "stop()"


@pytest.mark.parametrize("code", COMMANDS)
def test_every_stop_word_halts_in_the_middle_of_a_command(code):
    first, second, *_ = COMMANDS[code]["apartment"]
    for word in LANGUAGES[code].stop.anywhere:
        assert SafetyWords(code).find(f"{first} {word.capitalize()}! {second}"), word


@pytest.mark.parametrize(("code", "body", "sentence", "word"), REFUSED)
def test_an_unknown_word_is_refused_by_name_in_its_language(
    recognisers, code, body, sentence, word
):
    found = recognisers[code, body].recognise(sentence)

    assert isinstance(found, RefusedCommand)
    assert word in found.reason
    assert "I know" not in found.reason


@pytest.mark.parametrize("code", LANGUAGES)
def test_english_commands_are_understood_in_every_language(recognisers, code):
    found = recognisers[code, "apartment"].recognise("Go to the living room, please.")

    assert found == Understood((Call("navigate_to", {"room": "living_room"}),))


def test_every_language_is_tried_with_four_commands_for_each_body():
    assert COMMANDS.keys() == LANGUAGES.keys() - {"en"}
    assert all(len(bodies[body]) >= 4 for bodies in COMMANDS.values() for body in BODIES)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("fr", "Va dans la salle_des_machines."),
        ("it", "Vai nella salle des machines."),
        ("ja", "salle des machinesに行って。"),
        ("fr", "Va au labo !"),
    ],
)
def test_a_place_that_no_phrasebook_knows_goes_by_its_own_names(code, said):
    rooms = OneOf(("salle_des_machines",), {"labo": "salle_des_machines"})

    @skill()
    def navigate_to(goal, location: Annotated[str, rooms]):
        """Drive to a location."""

    found = Recogniser(SkillSet([navigate_to]), code).recognise(said)

    assert found == Understood((Call("navigate_to", {"location": "salle_des_machines"}),))


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("fr", "VA À LA CUISINE !"),
        ("fr", "va a la cuisine"),
        ("fr", "Va à l\N{RIGHT SINGLE QUOTATION MARK}office."),
        ("es", "¡ve a la cocina!"),
        ("tr", "MUTFAĞA GİT."),
        ("de", "fahr in die kueche"),
        ("zh", "請去 廚房。"),
        ("ja", "キッチン に 行って！"),
    ],
)
def test_spelling_punctuation_and_case_do_not_matter(recognisers, code, said):
    assert isinstance(recognisers[code, "apartment"].recognise(said), Understood)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("fr", "J'ai faim."),
        ("fr", "Va chercher le pain à la boulangerie."),
        ("es", "Tengo sueño."),
        ("it", "Che bella giornata!"),
        ("pt", "O que você acha do tempo?"),
        ("de", "Ich habe Hunger."),
        ("ja", "お腹が空きました。"),
        ("zh", "我饿了。"),
    ],
)
def test_anything_else_is_left_to_the_model(recognisers, code, said):
    assert recognisers[code, "apartment"].recognise(said) is None


def _written(call: Call) -> str:
    values = (
        f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}"
        for name, value in call.arguments.items()
    )
    return f"{call.skill}({', '.join(values)})"
