import pytest

from edgevox.agent.nlu.disfluencies import fluent, is_back_channel
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.stop.words import SafetyWords
from edgevox.agent.text.spelling import key
from edgevox.core.languages import LANGUAGES


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("uh go to the kitchen", "go to the kitchen"),
        ("go, uhhh, to the kitchen", "go, to the kitchen"),
        ("and then walk on uh ten metres", "walk on ten metres"),
        ("Ha, go to the kitchen", "go to the kitchen"),
        ("okay so move forward", "move forward"),
        ("t turn left", "turn left"),
        ("robot go b back", "robot go back"),
        ("walk kkk five metres", "walk five metres"),
        ("drive on drive on two metres", "drive on two metres"),
        ("walk walk back", "walk back"),
    ],
)
def test_what_is_no_word_of_the_sentence_is_left_out(said: str, meant: str) -> None:
    assert fluent(said, "en") == meant


@pytest.mark.parametrize(
    "said",
    [
        "go to x 2 y 2",
        "go to 2 2",
        "move 5 m",
        "move 5 mm",
        "go to shelf b",
        "x 1 x",
        "turn left then go to the kitchen and the office",
        "go to the tv",
    ],
)
def test_what_is_a_word_stays(said: str) -> None:
    assert fluent(said, "en") == said


@pytest.mark.parametrize("said", ["uh", "and then", "okay", "uh, um"])
def test_where_nothing_else_is_said_it_stays(said: str) -> None:
    assert fluent(said, "en") == said


def test_languages_without_spaces_lose_theirs() -> None:
    assert fluent("えーと、キッチンに行って", "ja") == "キッチンに行って"
    assert fluent("嗯,去厨房", "zh") == "去厨房"


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_listeners_say_is_no_stop_and_no_no(language):
    said = phrasebook(language).hearing.back_channels
    stops, answers = SafetyWords(language), phrasebook(language).answers

    assert len(said) >= 10
    assert all(is_back_channel(one, language) for one in said)
    assert [one for one in said if stops.find(one)] == []
    assert {key(one) for one in said} & {key(one) for one in (*answers.no, *answers.not_)} == set()


@pytest.mark.parametrize(
    ("text", "language", "listens"),
    [
        ("Mm-hmm.", "en", True),
        ("Hmmmm", "en", True),
        ("M-M-Hum.", "en", True),
        ("Oh, I see. Cool.", "en", True),
        ("Ah, d'accord.", "fr", True),
        ("うん、なるほど。", "ja", True),
        ("嗯,好的。", "zh", True),
        ("yeah, go to the kitchen", "en", False),
        ("no", "en", False),
        ("right turn", "en", False),
        ("台所へ", "ja", False),
    ],
)
def test_who_only_listens_says_nothing_else(text, language, listens):
    assert is_back_channel(text, language) is listens
