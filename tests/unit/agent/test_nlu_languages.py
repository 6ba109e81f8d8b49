"""What each of the sixteen languages knows of function words and of letters."""

from dataclasses import fields

import pytest
from support.bodies import BODIES

from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.lexicon import FunctionWords, words_of
from edgevox.core.languages import LANGUAGES

NEEDLESS = {"ja": {"reversals"}}
"""Japanese says in the verb what is done first."""
OWN = {
    *("wishes", "reasons", "plans", "pronouns", "linking", "gerunds", "copulas", "misheard"),
    "inverted",
}
"""What helps to read more orders, where it is listed, and holds nothing back where it is not."""


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_lists_every_class_of_function_words(language: str) -> None:
    words = words_of(language)
    missing = {one.name for one in fields(FunctionWords) if not getattr(words, one.name)}

    assert missing - OWN - NEEDLESS.get(language, set()) == set()


def test_marks_within_a_word_do_not_part_it() -> None:
    judged = Readings(BODIES["apartment"], "hi").of("कृपया रसोई में जाओ")

    assert judged is not None
    assert judged.reading.tokens == ("कृपया", "रसोई", "में", "जाओ")
    assert judged.evidence["strange"] == 0
