"""Every language is spoken to in `CODE.yaml`; a stop word is heard in the middle of it."""

from pathlib import Path

import pytest
from dialogue import Dialogue, dialogues
from support.bodies import BODIES

from edgevox.agent.stop.words import SafetyWords
from edgevox.core.languages import LANGUAGES

OFFICE = ("another place after a question", "another place after a wrong start")


def told(code: str) -> list[Dialogue]:
    return [*dialogues(Path(__file__).with_name(f"{code}.yaml").read_text("utf-8"))]


def orders(code: str, robot: str) -> list[str]:
    """Sentences that the robot does something for."""
    found = [one for one in told(code) if one.header.get("robot") == robot]
    return [line["say"] for one in found for line in one.lines if line.get("does")]


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_language_is_tried_with_commands_for_each_body_and_with_corrections(code):
    assert all(code == one.header["language"] for one in told(code))
    assert code == "en" or all(len(orders(code, body)) >= 4 for body in BODIES)
    assert all(any(title in one.title for one in told(code)) for title in OFFICE)


@pytest.mark.parametrize("code", sorted(LANGUAGES.keys() - {"en"}))
def test_every_stop_word_halts_in_the_middle_of_a_command(code):
    first, second, *_ = orders(code, "apartment")
    for word in LANGUAGES[code].stop.anywhere:
        assert SafetyWords(code).find(f"{first} {word.capitalize()}! {second}"), word
