import json
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.agent_events import GoalChanged, GoalStatus
from edgevox.core.errors import InvalidValue
from edgevox.ros2.contract import write
from edgevox.ros2.skill_action import MAX_ARGUMENTS_BYTES, mirror, read_arguments

JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=10,
)


@pytest.mark.parametrize("text", ["", "  \n", "{}"])
def test_no_arguments_may_be_said_in_three_ways(text):
    assert read_arguments(text) == {}


@pytest.mark.parametrize("text", ['{"x": 1}', "{", "null", '{"x": NaN}', "\0", "x" * 100_000])
def test_a_stop_with_wrong_arguments_is_still_a_stop(text):
    assert read_arguments(text, "stop") == {}


@given(st.text())
def test_any_text_is_an_object_or_refused_by_name(text):
    try:
        arguments, refused = read_arguments(text), ""
    except InvalidValue as error:
        arguments, refused = {}, error.field
    assert isinstance(arguments, dict)
    assert refused in {"", "arguments_json"}


@pytest.mark.parametrize(
    "text",
    [
        '{"x": NaN}',
        '{"x": 1, "x": 2}',
        '{"x": 1e999}',
        '{"x": -Infinity}',
        '{"x": "\\ud800"}',
        "\ud800",
        "[1]",
        "null",
        '"text"',
        "{'x': 1}",
        "{",
        "[" * 60_000,
        '{"a":' * 12_000,
        '{"x": ' + "9" * 10_000 + "}",
        '{"x": "' + "a" * MAX_ARGUMENTS_BYTES + '"}',
        '{"x": "' + "ä" * (MAX_ARGUMENTS_BYTES // 2) + '"}',
    ],
)
def test_what_is_not_a_json_object_of_a_sane_size_is_refused(text):
    with pytest.raises(InvalidValue, match="arguments_json: got"):
        read_arguments(text)


@given(st.dictionaries(st.text(), JSON))
def test_arguments_survive_the_wire(arguments):
    assert read_arguments(json.dumps(arguments)) == arguments


@given(st.dictionaries(st.text(), JSON | st.floats()))
def test_what_is_written_is_strict_json_and_unicode(data):
    text = write(data)
    text.encode()

    def refuse(constant):
        raise AssertionError(constant)

    assert json.loads(text, parse_constant=refuse).keys() == data.keys()


def test_what_is_not_finite_or_not_unicode_is_written_all_the_same():
    data = {"far": math.inf, "list": [1.5, math.nan], "half": "\ud800"}
    assert json.loads(write(data)) == {"far": None, "list": [1.5, None], "half": "\ud800"}


def test_feedback_mirrors_the_event_and_lifts_its_progress():
    accepted = GoalChanged("1", "drive", {"far": 2}, GoalStatus.ACCEPTED, turn=0)
    told = {
        "kind": "skill_goal",
        "goal_id": "1",
        "skill": "drive",
        "arguments": {"far": 2},
        "status": "accepted",
        "turn": 0,
    }
    assert json.loads(mirror(accepted)) == told
    feedback = {"progress": 0.25, "x": 1}
    further = replace(accepted, status=GoalStatus.RUNNING, feedback=feedback)
    told |= {"status": "running", "feedback": feedback, "progress": 0.25}
    assert json.loads(mirror(further)) == told
