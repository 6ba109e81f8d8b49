import pytest
from support.bodies import BODIES, SKILLS

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.text.words import SpokenNumber
from edgevox.core.languages import LANGUAGES

OTHERS = [code for code in LANGUAGES if code != ENGLISH]
RESULTS = {
    "room": "living room",
    "location": "living room",
    "x": 2.0,
    "y": -0.25,
    "z": 0.3,
    "yaw_deg": 90.0,
    "percent": 87,
    "walked": 1.02,
    "turned": 89.6,
    "got_up": True,
    "fallen": False,
    "held": "red_cube",
    "released": "blue_cube",
    "name": "wine_cellar",
    "names": ["kitchen", "office"],
    "objects": {"red_cube": {"x": 0.5, "on": "table"}, "blue_cube": {"x": 0.5, "on": "hand"}},
}
ARGUMENTS = {"room": "kitchen", "x": 1.5, "y": 2.0, "z": 0.25, "distance": 0.5, "degrees": 90.0}
ARGUMENTS |= {"object": "red_cube", "target": "left_bin", "name": "wine_cellar"}


@pytest.mark.parametrize("code", OTHERS)
def test_what_is_said_of_a_skill_is_whole_and_not_english(code):
    book, english = phrasebook(code), phrasebook(ENGLISH)
    for name, one in SKILLS.items():
        arguments = {a: ARGUMENTS[a] for a in one.arguments_model.model_fields}
        for said, usual in (
            (book.acknowledge(one, arguments), english.acknowledge(one, arguments)),
            (book.report(one, arguments, RESULTS), english.report(one, arguments, RESULTS)),
        ):
            assert bool(said) == bool(usual), name
            assert not said or said != usual, name
            assert not set("{}_<>") & set(said), name
            assert "None" not in said, name
            assert "the " not in said, name


@pytest.mark.parametrize("code", OTHERS)
def test_whether_to_do_something_is_asked_whole_and_not_in_english(code):
    for name, one in SKILLS.items():
        if not one.drives:
            continue
        arguments = {a: ARGUMENTS[a] for a in one.arguments_model.model_fields}
        asked = phrasebook(code).question([(one, arguments)])
        both = phrasebook(code).question([(one, arguments), (one, arguments)])

        for text in (asked, both):
            assert text.rstrip()[-1] in "?？؟", name
            assert not set("{}_<>") & set(text), name
            assert "None" not in text, name
            assert "hall I" not in text, name
        assert len(both) > len(asked), name


@pytest.mark.parametrize(("number", "said"), [(5.0, "5"), (4.97, "5"), (2.53, "2.5"), (-0.01, "0")])
def test_a_number_is_said_without_a_fraction_of_zero(number, said):
    walk = BODIES["humanoid"]["walk_forward"]
    done = phrasebook("en").report(walk, {"distance": number}, {"walked": number})
    assert done == f"I have walked {said} metres forward."


@pytest.mark.parametrize(
    ("number", "spec", "said"),
    [
        (41.26, "", "41.26"),
        (2.0, "", "2"),
        (2.04, ".1f", "2"),
        (0.25, ".3g", "0.25"),
        (-0.0, "", "0"),
    ],
)
def test_a_number_is_said_as_people_say_it(number: float, spec: str, said: str) -> None:
    assert format(SpokenNumber(number), spec) == said
    assert str(SpokenNumber(number)) == format(SpokenNumber(number), "")
