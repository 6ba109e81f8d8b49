"""A scenario file is read as it was meant. Wrong ones: tests/wrong/scenario."""

import re
from pathlib import Path

from edgevox.core.settings import Settings
from edgevox.scenario.format import SETTABLE, STEPS, Compare, Scenario, parse_scenario

ROOT = Path(__file__).parents[3]

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
