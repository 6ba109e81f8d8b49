"""A YAML file says everything once."""

import pytest

from edgevox.core.errors import InvalidValue
from edgevox.core.files.yaml_file import parse_yaml

TWICE = "dock: {x: 0, y: 0}\ndesk: {x: 1, y: 1}\ndock: {x: 2, y: 2}\n"


@pytest.mark.parametrize(
    ("text", "key", "lines"),
    [
        (TWICE, "dock", "line 3 repeats line 1"),
        ("a: {x: 1, x: 2}", "x", "line 1 repeats line 1"),
        ("a:\n  - b: 1\n    c: 2\n    b: 3", "b", "line 4 repeats line 2"),
        ("a: 1\n'a': 2", "a", "line 2 repeats line 1"),
        ("1: a\n0x1: b", 1, "line 2 repeats line 1"),
        ("yes: a\ntrue: b", True, "line 2 repeats line 1"),
        ("base: &b {x: 1}\nother: {<<: *b, y: 1, y: 2}", "y", "line 2 repeats line 2"),
    ],
)
def test_a_key_that_stands_twice_is_refused_with_the_file_the_key_and_its_lines(
    text, key, lines
) -> None:
    with pytest.raises(InvalidValue) as refused:
        parse_yaml(text, "home.yaml")
    assert (refused.value.field, refused.value.value) == ("home.yaml", key)
    assert lines in refused.value.expected


def test_the_same_key_may_stand_in_several_mappings_and_override_what_is_merged() -> None:
    text = "a: &a {x: 1, y: 1}\nb: &b {<<: *a, x: 2}\nc: {x: 3, <<: [*b, *a]}\nd: *b"
    assert parse_yaml(text, "home.yaml") == {
        "a": {"x": 1, "y": 1},
        "b": {"x": 2, "y": 1},
        "c": {"x": 3, "y": 1},
        "d": {"x": 2, "y": 1},
    }


@pytest.mark.parametrize(
    "text",
    ["a: !!int ''", "a: !!bool maybe", "a: !!timestamp now", "a: 1" + ":59" * 400 + ".5"],
)
def test_a_value_that_is_not_what_its_tag_says_is_refused_with_its_line(text) -> None:
    with pytest.raises(InvalidValue, match=r"home\.yaml:1: "):
        parse_yaml(text, "home.yaml")


def test_numbers_and_merges_that_multiply_are_refused_before_they_take_the_memory() -> None:
    merged = ["a0: &a0 {" + ", ".join(f"k{i}: 1" for i in range(10)) + "}"]
    merged += [f"a{i}: &a{i} {{<<: [{', '.join([f'*a{i - 1}'] * 10)}]}}" for i in range(1, 30)]
    for text, why in {"\n".join(merged): "multiply", "a: 1" + ":59" * 9999: "characters"}.items():
        with pytest.raises(InvalidValue, match=why):
            parse_yaml(text, "home.yaml")
