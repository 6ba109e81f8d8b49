"""The reasons that robots give, by their codes: English ones stand where all other languages do."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from edgevox.agent.text.spelling import key
from edgevox.agent.text.words import SpokenNumber, Word, word_of
from edgevox.core.languages import language_file
from edgevox.core.reason import Named, Reason, in_english

About = str | tuple[str, ...] | Reason | Named
"""What a reason is about."""


def because(code: str, text: str = "", /, **values: About) -> Reason:
    """The reason of this code. Raises `KeyError` for one that `languages/en.toml` does not have.

    `text` is the English sentence for programs, where it says more than the phrasebook does. What
    the phrasebook itself has for programs stands in its table `errors`.
    """
    english = _english()
    sentence = english.get("errors", {}).get(code) or english["reasons"][code]
    return Reason(text or in_words(sentence, values), code, values)


def called_off(why: str) -> Reason:
    """Why a body's motion was called off, of the table `called_off` of `languages/en.toml`.

    People hear the same sentence whatever it was, in their language; programs read this one.
    """
    text = _english()["called_off"][why]
    return because("called_off", text)


def number(value: float) -> str:
    """A number of a reason as people say it: at most one decimal, and 2 rather than 2.0."""
    return f"{SpokenNumber(value):.1f}"


def in_words(sentence: str, values: Mapping[str, About]) -> str:
    """An English sentence of a reason, with what it is about."""
    return sentence.format(**{name: _told(value) for name, value in values.items()})


def _told(value: About) -> Word | str:
    """What a reason is about, as its sentence needs it: a plain word has forms."""
    said = in_english(value).rstrip(".")
    return _words().get(key(said)) or _unknown().called(said) if isinstance(value, str) else said


@cache
def _english() -> Mapping[str, Any]:
    return language_file("en")


@cache
def _words() -> Mapping[str, Word]:
    return {key(name): word_of(one) for name, one in _english()["words"].items()}


@cache
def _unknown() -> Word:
    return word_of(_english()["unknown"])
