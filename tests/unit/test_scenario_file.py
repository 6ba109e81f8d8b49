"""A scenario file is read as it was meant, or refused with the field, its line, what is right."""

import re
from pathlib import Path

import pytest

from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.scenario import load_scenario
from edgevox.scenario.comparisons import Compare
from edgevox.scenario.reading import parse_scenario
from edgevox.scenario.scenario import MAX_STEPS, SETTABLE, Scenario
from edgevox.scenario.scenario_steps import STEPS

ROOT = Path(__file__).parents[2]

WHOLE = """\
about: all there is
agent: robot-apartment
settings: {seed: 3, llm: none}
limit_s: 20
never:
  - state: {collisions: {above: 0}}
steps:
  - say: go to the kitchen
  - interrupt: true
  - run: navigate_xy
    with: {x: 1, y: 2.5}
  - drive: {linear: 0.3, angular: -0.5, seconds: 2}
  - wait: 1.5
  - expect:
      state: {room: kitchen, goal: null, pose.x: {near: 6, by: 0.5}}
      answer: kitchen
      event: {kind: skill_goal, status: succeeded}
    within: 60
"""


def test_all_there_is_can_be_read_and_says_what_it_is():
    scenario = parse_scenario(WHOLE, "whole.yaml")
    assert scenario.agent == ("robot-apartment",)
    assert scenario.settings == {"seed": 3, "llm": "none"}
    assert [str(step) for step in scenario.steps] == [
        "say 'go to the kitchen'",
        "interrupt",
        "run navigate_xy(x=1, y=2.5)",
        "drive at 0.3 m/s and -0.5 rad/s for 2 s",
        "wait 1.5 s",
        (
            "expect room = 'kitchen', goal = None, pose.x = 6.0 ± 0.5, answer with 'kitchen',"
            " event with kind = 'skill_goal', status = 'succeeded' within 60 s"
        ),
    ]
    assert str(scenario.never[0]) == "collisions > 0"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "steps:\n  - say: hi\n  - expct: {answer: hi}\n",
            "s.yaml:3: steps.1: .*a step with one of",
        ),
        ("steps:\n  - say: hi\n    within: 3\n", "s.yaml:3: steps.0.within: got 3, .*no such key"),
        ("steps: []\n", "s.yaml:1: steps: .*at least 1 item"),
        ("about: nothing\n", "s.yaml:1: steps: got None, expected a value"),
        (
            "steps:\n  - wait: -1\n",
            "s.yaml:2: steps.0.wait: got -1, expected greater than or equal",
        ),
        ("steps:\n  - wait: .nan\n", "s.yaml:2: steps.0.wait: got nan"),
        ("steps:\n  - interrupt: please\n", "steps.0.interrupt: got 'please', expected True"),
        ("steps:\n  - expect: {}\n", "steps.0.expect: .*at least one of state, answer, event"),
        (
            "steps:\n  - expect:\n      state:\n        pose.x: {near: 1}\n",
            "s.yaml:4: steps.0.expect.state.pose.x: .*near and by together",
        ),
        (
            "steps:\n  - expect: {answer: no}\n",
            "answer: got False, expected a mapping.*quote words",
        ),
        ("steps:\n  - expect: kitchen\n", "steps.0.expect: got 'kitchen', expected a mapping"),
        (
            "steps:\n  - expect: {answer: {matches: '('}}\n",
            "steps.0.expect.answer.matches: got '\\(', expected a regular expression",
        ),
        ("steps:\n  - expect: {state: {a b: 1}}\n", "steps.0.expect.state.a b"),
        (
            "never: [{state: {a: 1}, answer: b}]\nsteps: [{wait: 1}]\n",
            "never.0: .*only one of state, answer, event",
        ),
        ("settings: {ros2: true}\nsteps: [{wait: 1}]\n", "settings: .*only language, voice, llm"),
        ("limit_s: 0\nsteps: [{wait: 1}]\n", "limit_s: got 0, expected greater than 0"),
        ("- say: hi\n", "s.yaml: got .*expected a mapping with steps"),
        ("steps: [\n", "s.yaml: .*valid YAML"),
    ],
)
def test_what_is_wrong_is_said_with_its_field_and_line(text, said):
    with pytest.raises(InvalidValue, match=said):
        parse_scenario(text, "s.yaml")


def test_a_file_may_not_be_endless():
    steps = "  - wait: 1\n" * (MAX_STEPS + 1)
    with pytest.raises(InvalidValue, match="steps: .*at most 1000 items"):
        parse_scenario(f"steps:\n{steps}", "s.yaml")


def test_a_file_that_is_not_there_is_refused():
    with pytest.raises(InvalidValue, match="scenario: got 'nowhere.yaml', expected a file"):
        load_scenario(Path("nowhere.yaml"))


def test_the_json_schema_knows_every_step_and_comparison():
    schema = Scenario.model_json_schema()
    kinds = [schema["$defs"][one["$ref"].rpartition("/")[2]] for one in steps_of(schema)]
    assert [kind["required"] for kind in kinds] == [[key] for key in STEPS]
    assert "near" in schema["$defs"]["Compare"]["properties"]


def steps_of(schema):
    return schema["properties"]["steps"]["items"]["oneOf"]


def test_the_example_of_the_documentation_can_be_read():
    page = (ROOT / "docs" / "scenarios.md").read_text()
    (text, *_) = re.findall(r"^```yaml\n(about.*?)^```", page, re.DOTALL | re.MULTILINE)
    scenario = parse_scenario(text, "scenarios.md")
    assert len(scenario.steps) == 6
    assert len(scenario.never) == 2


def test_the_documentation_names_every_step_comparison_and_setting():
    page = (ROOT / "docs" / "scenarios.md").read_text()
    for name in (*STEPS, *Compare.model_fields, *SETTABLE):
        assert re.search(rf"`[^`]*\b{name}\b[^`]*`", page), name


def test_a_scenario_makes_no_setting_that_there_is_not():
    assert set(SETTABLE) <= set(Settings.model_fields)
