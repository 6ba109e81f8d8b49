"""JSON from outside is read one way or refused by name."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import DEEPEST, read_json, read_json_object

JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**60), 2**60)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=10,
)


@given(JSON)
def test_what_was_written_is_read_as_it_was(data) -> None:
    assert read_json(json.dumps(data), "message") == data
    assert read_json(json.dumps(data).encode(), "message") == data


@given(st.text() | st.binary())
def test_any_text_is_a_value_of_finite_numbers_or_refused_by_its_field(text) -> None:
    try:
        data, field = read_json(text, "message"), "message"
    except InvalidValue as error:
        data, field = None, error.field
    assert field == "message"
    assert json.dumps(data, allow_nan=False)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"x": 1, "x": 2}', "'x' is there more than once"),
        ('{"a": [{"x": 1, "x": 1}]}', "'x' is there more than once"),
        ('{"x": 1, "\\u0078": 2}', "'x' is there more than once"),
        ('{"x": NaN}', "NaN is none"),
        ('{"x": -Infinity}', "-Infinity is none"),
        ('{"x": 1e999}', "1e999 is none"),
        ("[-1e400]", "-1e400 is none"),
        ("[" * (DEEPEST + 1) + "]" * (DEEPEST + 1), "inside each other"),
        ("[" * 100_000, "valid JSON"),
        ('{"x": "\\ud800"}', "valid JSON"),
        ("9" * 10_000, "valid JSON"),
        ("{'x': 1}", "valid JSON"),
        ("", "valid JSON"),
        (b"\xff\xfe\xfd", "valid JSON"),
        ('"' + "a" * 1_000_000 + '"', "at most 1000000 bytes"),
    ],
)
def test_what_two_parsers_could_read_differently_is_refused(text, expected) -> None:
    with pytest.raises(InvalidValue) as refused:
        read_json(text, "message")
    assert refused.value.field == "message"
    assert expected in refused.value.expected


def test_what_is_as_deep_as_may_be_is_read() -> None:
    assert read_json("[" * DEEPEST + "]" * DEEPEST, "message")


@pytest.mark.parametrize("text", ["[1]", "null", '"text"', "1"])
def test_what_must_be_an_object_is_refused_where_it_is_none(text) -> None:
    with pytest.raises(InvalidValue, match="expected a JSON object"):
        read_json_object(text, "message")


def test_numbers_keep_their_kind() -> None:
    assert read_json_object('{"a": 1, "b": 1.0, "c": true}', "message") == {
        "a": 1,
        "b": 1.0,
        "c": True,
    }
    assert math.isclose(read_json("1e308", "message"), 1e308)
