"""Names and wake words, however speech to text spells them."""

import pytest

from edgevox.core.spoken_names import named_in, without_name, without_phrase


@pytest.mark.parametrize(
    ("text", "name", "rest"),
    [
        ("Rosie, go to the kitchen.", "Rosie", "go to the kitchen."),
        ("Rosie go to the kitchen.", "Rosie", "go to the kitchen."),
        ("Hey Rosee, go to the kitchen.", "Rosie", "go to the kitchen."),
        ("Go to the kitchen, Rosie.", "Rosie", "Go to the kitchen"),
        ("Wall-E, come here!", "Wall E", "come here!"),
        ("Wally, come here!", "Wall E", "come here!"),
        ("ロージー、キッチンへ行って", "ロージー", "キッチンへ行って"),
        ("Rosie?", "Rosie", "Rosie?"),
    ],
)
def test_a_name_is_called_at_the_beginning_or_the_end_and_is_no_part_of_the_order(text, name, rest):
    names = {"a": name, "b": "Bender"}
    assert named_in(text, names) == "a"
    assert without_name(text, name) == rest


@pytest.mark.parametrize(
    "text",
    ["Tell Rosie to go to the kitchen.", "Go to Rosie and stop there.", "", "Go to max speed now."],
)
def test_a_name_within_an_order_calls_nobody(text):
    assert named_in(text, {"a": "Rosie", "b": "Max"}) == ""
    assert without_name(text, "Rosie") == text


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("Hey Jarvis, go to the kitchen.", "go to the kitchen."),
        ("Hey, Darvie's go to the kitchen.", "go to the kitchen."),
        ("Hey Travis, stop", "stop"),
        ("um hey Jarvis stop", "stop"),
        ("Jarvis. Turn left", "Turn left"),
        ("Hey Jarvis", ""),
        ("Go to the kitchen.", "Go to the kitchen."),
        ("", ""),
    ],
)
def test_the_wake_word_is_taken_out_however_it_was_spelt(text, command):
    assert without_phrase(text, "hey jarvis") == command
