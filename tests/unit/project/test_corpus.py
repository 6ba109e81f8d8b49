"""The corpus of what people say: its two halves, and that the held-out one stays unseen."""

import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from corpus_robots import is_right, skills_of_robots
from corpus_sentences import ROBOTS, held_out, is_held_out, read_corpus, tuning

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call
from edgevox.agent.text.spelling import key

ROOT = Path(__file__).parents[3]
LANGUAGES = {"de": 60, "es": 60, "fr": 60, "ja": 60, "zh": 60} | dict.fromkeys(
    ("ar", "hi", "id", "it", "nl", "pl", "pt", "ru", "tr", "vi"), 30
)
"""How many sentences each language beside English has at least."""


def product_sentences() -> Iterator[str]:
    """Whatever the product shows to a model, says as an example, or was trained with."""
    for file in (ROOT / "edgevox").rglob("*.toml"):
        yield from strings(tomllib.loads(file.read_text(encoding="utf-8")))
    for skills in skills_of_robots().values():
        for one in skills.values():
            for language in LANGUAGES:
                yield from (e.sentence for e in phrasebook(language).examples(one))
    for file in (ROOT / "training" / "decision").rglob("*.yaml"):
        for data in yaml.load_all(file.read_text(encoding="utf-8"), yaml.CSafeLoader):
            yield from strings(data)


def strings(data: object) -> Iterator[str]:
    if isinstance(data, str):
        yield data
    elif isinstance(data, dict):
        yield from (text for pair in data.items() for one in pair for text in strings(one))
    elif isinstance(data, list):
        yield from (text for one in data for text in strings(one))


def test_nothing_of_the_product_holds_a_sentence_of_the_held_out_half() -> None:
    unseen = {key(one.says): one.category for one in held_out() if len(key(one.says)) > 12}
    found = {key(text) for text in product_sentences()} & unseen.keys()

    assert len(found) == 0, f"{len(found)} sentences, of {sorted({unseen[one] for one in found})}"


def test_the_halves_are_about_as_large_and_share_no_sentence() -> None:
    seen, unseen = ({key(one.says) for one in half} for half in (tuning(), held_out()))

    assert not seen & unseen
    assert 0.8 < len(seen) / len(unseen) < 1.25


def test_the_half_of_a_sentence_does_not_hang_on_its_spelling() -> None:
    assert is_held_out("Go to the kitchen!") == is_held_out("go to the  kitchen")


def test_the_corpus_is_large_and_mostly_no_commands() -> None:
    english = [one for one in read_corpus() if one.language == "en"]

    assert len(english) >= 1000
    assert sum(not one.is_command for one in english) * 2 >= len(english)


@pytest.mark.parametrize("language", LANGUAGES)
def test_other_languages_have_their_sentences(language: str) -> None:
    assert sum(one.language == language for one in read_corpus()) >= LANGUAGES[language]


def test_every_call_of_the_corpus_is_one_of_its_robot() -> None:
    skills = skills_of_robots()

    for one in read_corpus():
        assert one.robot in ROBOTS
        for call in (call for outcome in one.outcomes for call in outcome):
            assert call.skill in skills[one.robot], one.category


def test_a_default_that_is_left_out_is_as_right_as_one_that_is_named() -> None:
    (one, *_) = [o for o in tuning() if o.outcomes[0] == (Call("turn_left", {"degrees": 90.0}),)]

    assert is_right(one, one.robot, (Call("turn_left"),))
    assert not is_right(one, one.robot, (Call("turn_right"),))
