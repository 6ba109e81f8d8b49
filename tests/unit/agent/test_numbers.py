import re

import pytest

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.numbers import digits
from edgevox.core.languages import LANGUAGES


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


@pytest.mark.parametrize(
    ("language", "said", "written"),
    [
        ("en", "move forward one foot", "move forward 0.3048 meters"),
        ("en", "a foot and a half", "0.4572 meters"),
        ("en", "half a foot", "0.1524 meters"),
        ("en", "three quarters of an inch", "0.01905 meters"),
        ("en", "two and a half feet", "0.762 meters"),
        ("en", "a couple of yards", "1.8288 meters"),
        ("en", "one more foot", "0.3048 meters"),
        ("en", "twenty more degrees", "20 degrees"),
        ("en", "half a mile", "804.672 meters"),
        ("en", "three hundred millimetres", "0.3 meters"),
        ("en", "go to x 2 m y 50 cm", "go to x 2 m y 0.5 meters"),
        ("en", "get back on your feet", "get back on your feet"),
        ("ar", "5 أقدام", "1.524 متر"),
        ("ar", "تقدم متر واحد", "تقدم 1 متر"),
        ("de", "zwei Fuß vor", "0.6096 Meter vor"),
        ("es", "avanza dos pies", "avanza 0.6096 metros"),
        ("fr", "avance de trois pieds", "avance de 0.9144 mètres"),
        ("hi", "तीन फुट आगे", "0.9144 मीटर आगे"),
        ("id", "maju 2 kaki", "maju 0.6096 meter"),
        ("it", "avanti di due piedi", "avanti di 0.6096 metri"),
        ("ja", "三フィート進んで", "0.9144 メートル進んで"),
        ("nl", "twee voet vooruit", "0.6096 meter vooruit"),
        ("pl", "5 stóp do przodu", "1.524 metra do przodu"),
        ("pt", "dois pés para a frente", "0.6096 metros para a frente"),
        ("ru", "вперёд на пять футов", "вперёд на 1.524 метра"),
        ("tr", "üç adım ileri", "1.2 metre ileri"),
        ("vi", "tiến ba bước", "tiến 1.2 mét"),
        ("zh", "前进三英尺", "前进0.9144 米"),
    ],
)
def test_every_length_becomes_metres(language, said, written):
    assert digits(said, language) == written


@pytest.mark.parametrize(
    ("language", "said", "written"),
    [
        ("en", "five feet and six inches", "1.6764 meters"),
        ("en", "six feet two inches", "1.8796 meters"),
        ("de", "2 Meter und 50 Zentimeter", "2.5 Meter"),
        ("ja", "1メートル50センチ", "1.5 メートル"),
        ("en", "2 meters 4 meters", "2 meters 4 meters"),
        ("en", "2 inches 3 feet", "0.0508 meters 0.9144 meters"),
        ("en", "2 meters and -50 cm", "2 meters and -0.5 meters"),
    ],
)
def test_lengths_in_a_row_are_one_only_if_each_unit_is_smaller(language, said, written):
    assert digits(said, language) == written


@pytest.mark.parametrize(
    ("language", "said", "written"),
    [
        ("en", "turn left 0.5 rad", "turn left 28.6479 degrees"),
        ("en", "two full turns to the left", "720 degrees to the left"),
        ("en", "a third of a turn", "120 degrees"),
        ("en", "pi over two radians", "90 degrees"),
        ("en", "turn to your three o'clock", "turn right 90 degrees"),
        ("en", "turn left two times", "turn left 2 times"),
        ("en", "drive 2 metres turn left", "drive 2 metres turn left"),
        ("de", "0,5 Radiant nach links", "28.6479 Grad nach links"),
        ("fr", "2 tours complets", "720 degrés"),
        ("zh", "左转1弧度", "左转57.2958 度"),
    ],
)
def test_every_angle_becomes_degrees(language, said, written):
    assert digits(said, language) == written


def test_a_point_in_parentheses_gets_its_axes():
    assert digits("go to (3.2, -0.8)") == "go to x 3.2 y -0.8"
    assert digits("go to (0.4, 0, 0.3)") == "go to x 0.4 y 0 z 0.3"


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("kind", ["lengths", "angles"])
def test_each_unit_of_a_language_is_its_size(language, kind):
    known = getattr(phrasebook(language).numbers, kind)
    tried = {1.0}
    for pattern, size in known.units:
        for unit in re.sub(r"\([^)]*\)\??|\[[^]]*\]\??|.\?", "", pattern.pattern).split("|"):
            if unit and pattern.fullmatch(unit) and size != 1.0:
                tried.add(size)
                assert known.converted(f"3 {unit}") == f"{3 * size:.6g} {known.base}"
    assert tried == {1.0, *(size for _, size in known.units)}


def test_a_language_without_number_words_is_left_alone():
    assert digits("3 メートル進んで", "ja") == "3 メートル進んで"
