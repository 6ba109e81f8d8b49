"""What is said of skills that a robot file describes, in every language."""

import pytest

from edgevox.agent.phrases.load import phrasebook
from edgevox.core.languages import LANGUAGES
from edgevox.ros2.clients import interface_reason

CODES = (
    "not_there",
    "nobody_listens",
    "refused",
    "no_answer",
    "gave_up",
    "unheard",
    "not_so",
    "ended_by",
)
OTHER_LETTERS = {"ar", "hi", "ja", "ru", "zh"}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("code", CODES)
def test_why_an_interface_failed_is_said_in_every_language(language, code):
    reason = interface_reason(code, what="~/station/empty_bin")

    assert reason.sentences.keys() == LANGUAGES.keys()
    said = phrasebook(language).failure(reason)

    assert ("station empty bin" in said) is (code != "refused")  # the robot refused, whatever it is
    assert "{" not in said
    assert not said.endswith(("..", "。.", "。。", "।।", "।."))
    if language in OTHER_LETTERS:
        assert sum(one.isalpha() and not one.isascii() for one in said) >= 4
    elif language != "en":
        assert said != phrasebook("en").failure(reason)


@pytest.mark.parametrize("language", sorted(set(LANGUAGES) - {"en"}))
def test_no_two_reasons_are_the_same_in_a_language(language):
    told = {interface_reason(code, what="dock").sentences[language] for code in CODES}
    assert len(told) == len(CODES)
