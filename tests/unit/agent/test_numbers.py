import pytest

from edgevox.agent.phrases.numbers import digits


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


@pytest.mark.parametrize(
    ("language", "said", "written"),
    [
        ("ar", "خمسة وأربعين درجة", "45 درجة"),
        ("hi", "चालीस डिग्री", "40 डिग्री"),
        ("id", "empat puluh lima derajat", "45 derajat"),
        ("id", "dua koma lima", "2.5"),
        ("ja", "二十五度", "25度"),
        ("nl", "twee en een half", "2.5"),
        ("pl", "czterdzieści pięć stopni", "45 stopni"),
        ("pt", "menos um e meio", "-1.5"),
        ("ru", "два с половиной", "2.5"),
        ("tr", "iki buçuk", "2.5"),
        ("tr", "kırk beş derece", "45 derece"),
        ("vi", "bốn mươi hai độ", "42 độ"),
        ("zh", "三十公分", "0.3 米"),
    ],
)
def test_tens_and_halves_are_understood(language, said, written):
    assert digits(said, language) == written


def test_a_language_without_number_words_is_left_alone():
    assert digits("3 メートル進んで", "ja") == "3 メートル進んで"
