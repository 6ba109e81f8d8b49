import pytest

from edgevox.agent.numbers import digits


@pytest.mark.parametrize(
    ("said", "written"),
    [
        ("go to x two point five y minus one", "go to x 2.5 y -1"),
        ("drive two and a half meters", "drive 2.5 meters"),
        ("walk half a metre", "walk 0.5 metre"),
        ("half a meter", "0.5 meter"),
        ("turn ninety degrees", "turn 90 degrees"),
        ("move twenty five centimeters", "move 0.25 meters"),
        ("30 cm to the left", "0.3 meters to the left"),
        ("go to 2.5 and -1", "go to 2.5 and -1"),
        ("hello there", "hello there"),
        ("Go to x2.5, y-1.", "Go to x 2.5, y -1."),
        ("Go to X2.5y -1", "Go to X 2.5 y -1"),
        ("1 1/2 meters", "1.5 meters"),
        ("turn 90°", "turn 90 degrees"),
    ],
)
def test_spoken_numbers_become_digits_in_metres(said, written):
    assert digits(said) == written


def test_french_number_words_are_understood():
    assert digits("avance de vingt-deux mètres", "fr") == "avance de 22 mètres"


def test_a_language_without_number_words_is_left_alone():
    assert digits("3 メートル進んで", "ja") == "3 メートル進んで"
