import pytest

from edgevox.agent.nlu.disfluencies import fluent


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
