"""Nothing that was said is dropped: what stands in no call leaves no call, in every language.

"Nothing" is what a robot without a language model makes of it: no template and no program takes it,
and no reading of it may be done or asked about.
"""

import itertools
from functools import cache
from pathlib import Path

import pytest
import yaml
from corpus_robots import skills_of_robots
from few_languages import few
from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.nlu.judging import Judged, Readings
from edgevox.agent.nlu.lexicon import words_of
from edgevox.agent.nlu.meaning import Program
from edgevox.agent.nlu.order_reader import ProgramReader
from edgevox.agent.nlu.remainder import may_ask_whether
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.numbers import is_exact
from edgevox.agent.skills import Call
from edgevox.core.files.text import clean

CODES = (
    *("ar", "de", "en", "es", "fr", "hi", "id", "it"),
    *("ja", "nl", "pl", "pt", "ru", "tr", "vi", "zh"),
)
KITCHEN = Call("navigate_to", {"room": "kitchen"})


@cache
def recogniser(robot: str, code: str) -> Recogniser:
    return Recogniser(skills_of_robots()[f"robot-{robot}"], code)


@cache
def readings(robot: str, code: str) -> Readings:
    return Readings(skills_of_robots()[f"robot-{robot}"], code)


def plain(robot: str, code: str, text: str) -> Understood | None:
    found = recogniser(robot, code).recognise(clean(text))
    return found if isinstance(found, Understood) else None


def read(robot: str, code: str, text: str) -> Judged | None:
    """A reading that may be done or asked about."""
    judged = readings(robot, code).of(clean(text))
    return None if judged is None or judged.held_back or judged.unsaid else judged


def calls(robot: str, code: str, text: str) -> tuple[Call, ...]:
    """Whatever could be done, or asked about, now."""
    if understood := plain(robot, code, text):
        return understood.calls
    judged = read(robot, code, text)
    return judged.reading.calls if judged else ()


def is_program(robot: str, code: str, text: str) -> bool:
    def of(part: str) -> tuple[Call, ...] | None:
        return calls(robot, code, part) or None

    return isinstance(ProgramReader(code).read(clean(text), of), Program)


def is_nothing(robot: str, code: str, text: str) -> bool:
    done = calls(robot, code, text)
    skills = skills_of_robots()[f"robot-{robot}"]
    return not any(skills[one.skill].drives or skills[one.skill].lasting for one in done)


def to_kitchen(code: str) -> str:
    """The plain order to go to the kitchen."""
    book = phrasebook(code)
    return book.programs.go.replace("{place}", book.word("kitchen").heard[0])


DENIALS = yaml.safe_load(Path(__file__).with_name("denials.yaml").read_text("utf-8"))
ROOMS = ("kitchen", "living_room", "bedroom", "office")


def denials(code: str) -> list[str]:
    places = [phrasebook(code).word(room).to for room in ROOMS]
    said = itertools.product(DENIALS[code]["front"], DENIALS[code]["denials"], places)
    return [front + denial.format(to=place) for front, denial, place in said]


@pytest.mark.parametrize("code", CODES)
def test_a_hundred_denials_of_a_drive_begin_nothing_and_ask_nothing(code: str) -> None:
    said = denials(code)
    assert len(set(said)) >= 100
    assert [one for one in said if not is_nothing("apartment", code, one)] == []
    assert [one for one in said if is_program("apartment", code, one)] == []


@pytest.mark.parametrize(
    "said",
    [
        "no more turning to the left, please", "quit walking forward", "turn left instead of right",
        "stand instead of walking forward", "walk forward rather than turning left",
        "that is enough turning left", "I decline to turn left", "say turn left", "let me through",
        "repeat after me turn left", "get ready to walk forward", "spell turn left",
    ],
)  # fmt: skip
@pytest.mark.parametrize("robot", ["humanoid", "apartment"])
def test_a_motion_that_is_to_end_or_is_not_wanted_does_not_begin(robot: str, said: str) -> None:
    judged = read(robot, "en", said)
    assert judged is None or judged.held_back or not calls(robot, "en", said)


def joined(code: str, *parts: str) -> str:
    return (" " if phrasebook(code).hearing.spaced else "").join(parts)


@pytest.mark.parametrize("code", CODES)
def test_the_plain_order_is_understood(code: str) -> None:
    assert calls("apartment", code, to_kitchen(code)) == (KITCHEN,)


@pytest.mark.parametrize("code", few(CODES))
def test_an_order_that_is_put_off_is_not_done_now(code: str) -> None:
    order = to_kitchen(code)
    for phrase in words_of(code).put_off:
        first, last = phrase.startswith("."), phrase.endswith(".")
        said = phrase.strip(". ")
        if not last:
            assert is_nothing("apartment", code, joined(code, said, order)), (said, order)
        if not first:
            assert is_nothing("apartment", code, joined(code, order, said)), (order, said)


@pytest.mark.parametrize("code", few(CODES))
def test_a_part_of_a_number_a_unit_or_a_time_that_no_value_takes_leaves_no_order(code: str) -> None:
    order = to_kitchen(code)
    for at, said in enumerate(words_of(code).amounts):
        text = joined(code, said, order) if at % 2 else joined(code, order, said)
        assert is_nothing("apartment", code, text), text


@pytest.mark.parametrize("code", few(CODES))
def test_a_bound_is_no_value(code: str) -> None:
    """ "At least two metres" says neither how far to go nor how far it may."""
    walks = {
        "ar": "امش إلى الأمام 2 متر", "de": "geh 2 Meter vor", "en": "walk forward 2 metres",
        "es": "avanza 2 metros", "fr": "avance de 2 mètres", "hi": "2 मीटर आगे चलो",
        "id": "jalan maju 2 meter", "it": "vai avanti di 2 metri", "ja": "2メートル進んで",
        "nl": "loop 2 meter vooruit", "pl": "idź 2 metry do przodu",
        "pt": "anda 2 metros para a frente", "ru": "пройди 2 метра вперёд",
        "tr": "2 metre ileri yürü", "vi": "đi tới 2 mét", "zh": "前进2米",
    }  # fmt: skip
    assert calls("humanoid", code, walks[code]) == (Call("walk_forward", {"distance": 2.0}),)
    for bound in words_of(code).bounds:
        text = walks[code].replace("2", joined(code, bound, "2"))
        assert is_nothing("humanoid", code, text), text


@pytest.mark.parametrize(
    ("robot", "text"),
    [
        ("apartment", "move robot 2 m with speed 0.5"),
        ("external", "move 4 meters with speed 3"),
        ("apartment", "go 3 by 4"),
        ("apartment", "drive 3 times 4"),
        ("apartment", "go to level 3 position 4"),
        ("apartment", "drive to x 3 furlongs y 4 furlongs"),
        ("humanoid", "walk forward 5'"),
        ("humanoid", "walk forward 1.5.2 meters"),
        ("humanoid", "walk forward 3-4 meters"),
        ("humanoid", "walk forward 1,500 meters"),
        ("humanoid", "walk forward 5\N{SUPERSCRIPT TWO} meters"),
        ("humanoid", "walk forward ~5 meters"),
        ("humanoid", "walk forward 5 + 3 meters"),
        ("humanoid", "walk forward point five meters"),
        ("humanoid", "walk forward a few meters"),
        ("humanoid", "walk forward at 50 percent"),
        ("humanoid", "walk forward two metres per second"),
        ("humanoid", "walk forward at least two metres"),
        ("humanoid", "walk two metres at most forward"),
        ("humanoid", "walk forward no more than two metres"),
        ("humanoid", "turn left up to 30 degrees"),
        ("apartment", "turn off the lamp in the bedroom"),
        ("apartment", "put the light on in the kitchen and wash it"),
        ("apartment", "later go to the kitchen"),
        ("apartment", "maybe head over to the office some time"),
        ("apartment", "in a moment go to the kitchen"),
        ("panda", "hold it tight"),
        ("apartment", "go in the dining room and remove the tablecloth"),
        ("apartment", "go to the kitchen and wash the dishes"),
        ("apartment", "remember the point x 7 y 2 as den"),
        ("apartment", "light up the kitchen"),
        ("apartment", "grab the cup on the left of the plate"),
    ],
)
def test_what_no_value_took_leaves_no_order(robot: str, text: str) -> None:
    assert is_nothing(robot, "en", text)


@pytest.mark.parametrize(
    ("robot", "code", "text"),
    [
        ("humanoid", "zh", "前进零点五米"),
        ("humanoid", "zh", "往前走两米五"),
        ("humanoid", "zh", "前进二点五米"),
        ("humanoid", "zh", "前进十几米"),
        ("humanoid", "ja", "一点五メートル下がって"),
        ("humanoid", "ja", "数メートル進んで"),
        ("humanoid", "hi", "साढ़े तीन मीटर आगे चलो"),
        ("humanoid", "hi", "दो दशमलव पाँच मीटर आगे चलो"),
        ("humanoid", "ar", "امش إلى الأمام مترين ونصف"),
        ("humanoid", "ar", "امش اثنين فاصلة خمسة متر"),
        ("humanoid", "pl", "idź dwa metry i pół do przodu"),
        ("humanoid", "nl", "loop tweeënhalve meter vooruit"),
        ("humanoid", "ru", "пройди вперёд две целых пять десятых метра"),
        ("humanoid", "tr", "iki virgül beş metre ileri yürü"),
        ("humanoid", "vi", "đi tới hai phẩy năm mét"),
        ("humanoid", "de", "geh drei Viertel Meter vor"),
        ("humanoid", "de", "geh 1.500 Meter vor"),
        ("humanoid", "es", "en minuto y medio avanza un metro"),
        ("apartment", "de", "in anderthalb Minuten geh in die Küche"),
        ("apartment", "fr", "dans une minute et demie va dans la cuisine"),
        ("apartment", "zh", "一分半钟后去厨房"),
        ("apartment", "ja", "一分半後に台所に行って"),
        ("apartment", "de", "mach die Schlafzimmerlampe an"),
        ("apartment", "de", "mach die Lampe im Schlafzimmer an"),
        ("apartment", "de", "geh in die Küche und spül das Geschirr"),
        ("apartment", "es", "ve a la cocina y lava los platos"),
        ("apartment", "ar", "اذهب إلى المطبخ واغسل الصحون"),
        ("apartment", "ja", "台所に行って皿を洗って"),
        ("apartment", "vi", "tiếp tục phim trong phòng khách"),
        ("apartment", "nl", "zet de slaapkamerlamp aan"),
        ("apartment", "es", "pon música en la sala de estar"),
        ("apartment", "ja", "寝室の電気をつけて"),
        ("apartment", "ja", "台所に行かないで"),
        ("apartment", "ja", "寝室に入らないでください"),
        ("apartment", "ja", "キッチンへ行っちゃだめ"),
        ("apartment", "ja", "台所には行くな"),
        ("apartment", "zh", "别进厨房"),
        ("apartment", "tr", "mutfağa gitme"),
    ],
)
def test_what_no_value_took_leaves_no_order_in_any_language(
    robot: str, code: str, text: str
) -> None:
    assert is_nothing(robot, code, text)


@pytest.mark.parametrize(
    ("robot", "text", "meant"),
    [
        ("humanoid", "walk forward .5 meters", Call("walk_forward", {"distance": 0.5})),
        ("humanoid", "walk forward 1/2 meter", Call("walk_forward", {"distance": 0.5})),
        ("humanoid", "walk forward 2\u00bd m", Call("walk_forward", {"distance": 2.5})),
        ("humanoid", "walk forward 4,5 meters", Call("walk_forward", {"distance": 4.5})),
        ("apartment", "drive 4,5 m", Call("drive_forward", {"distance": 4.5})),
        ("humanoid", "walk forward 500 mm", Call("walk_forward", {"distance": 0.5})),
        ("humanoid", "walk forward \N{MINUS SIGN}1 m", Call("walk_forward", {"distance": -1.0})),
        ("humanoid", "walk forward one and a half metres", Call("walk_forward", {"distance": 1.5})),
        ("humanoid", "turn half of a right angle right", Call("turn_right", {"degrees": 45.0})),
        ("apartment", "drive to x=2.5, y=.4", Call("navigate_xy", {"x": 2.5, "y": 0.4})),
        ("apartment", "drive to x 300 mm y 4 m", Call("navigate_xy", {"x": 0.3, "y": 4.0})),
        ("external", "goal at 5 metres x, 1 metre y", Call("navigate_xy", {"x": 5.0, "y": 1.0})),
        ("panda", "move to x .5, y .2, z .4", Call("move_to", {"x": 0.5, "y": 0.2, "z": 0.4})),
        ("apartment", "please go to the kitchen right now, my friend", KITCHEN),
        ("apartment", "when you have a minute, go to the kitchen", KITCHEN),
        ("apartment", "as soon as possible, to the kitchen", KITCHEN),
    ],
)  # fmt: skip
def test_a_mark_counts_and_courtesies_cost_nothing(robot: str, text: str, meant: Call) -> None:
    assert calls(robot, "en", text) == (meant,)


def test_a_time_that_can_be_read_is_kept_as_a_program() -> None:
    assert is_program("apartment", "en", "in two minutes go to the kitchen")
    assert is_program("apartment", "en", "in 1.5 minutes go to the kitchen")
    assert not is_program("apartment", "en", "in 1.5.2 minutes go to the kitchen")


@pytest.mark.parametrize("code", CODES)
def test_a_place_is_forgotten_unasked_only_in_its_own_words(code: str) -> None:
    """Words for wiping and switching off are asked about at most."""
    wiping = {
        "ar": "امسح المطبخ", "de": "lösch die Küche", "en": "erase the kitchen",
        "es": "borra la cocina", "fr": "efface la cuisine", "hi": "रसोई मिटा दो",
        "id": "hapus dapur", "it": "cancella la cucina", "ja": "キッチンを消して",
        "nl": "wis de keuken", "pl": "usuń kuchnię", "pt": "apaga a cozinha",
        "ru": "сотри кухню", "tr": "mutfağı sil", "vi": "xóa nhà bếp", "zh": "删除厨房",
    }  # fmt: skip
    judged = read("apartment", code, wiping[code])

    assert plain("apartment", code, wiping[code]) is None
    assert judged is None or judged.loses


@pytest.mark.parametrize("text", ["relax your fingers a little", "loosen the gripper"])
def test_what_is_held_is_let_go_of_unasked_only_in_its_own_words(text: str) -> None:
    judged = read("panda", "en", text)

    assert plain("panda", "en", "open the gripper") == Understood((Call("release"),))
    assert plain("panda", "en", text) is None
    assert judged is None or judged.loses


CHANGED = (
    *(f"{mark}5" for mark in "/*+~^#$<>\u00b1"),
    *(f"5{mark}" for mark in "'\"/*+~^#$<>\u00b1\u2032\u2033"),
)


@pytest.mark.parametrize(
    ("code", "text", "asks"),
    [
        ("en", "can you walk backwards", True),
        ("en", "can you walk backwards, please", False),
        ("en", "could you walk backwards", False),
        ("de", "kannst du rückwärts gehen", True),
        ("de", "kannst du bitte rückwärts gehen", False),
        ("es", "puedes caminar hacia atrás", True),
        ("zh", "你能后退吗", True),
    ],
)
def test_a_question_about_what_it_can_is_no_plain_order(code: str, text: str, asks: bool) -> None:
    assert may_ask_whether((Call("walk_backward"),), text, code) is asks
    assert not may_ask_whether((Call("walk_backward", {"distance": 2.0}),), text, code)


@given(st.sampled_from(CHANGED))
def test_a_mark_beside_a_number_that_changes_it_is_never_dropped(number: str) -> None:
    assert not is_exact(f"walk forward {number} meters")
    assert is_nothing("humanoid", "en", f"walk forward {number} meters")


@given(st.integers(0, 99), st.integers(0, 99), st.sampled_from([".", ":", "-", "/", ".1."]))
def test_two_numbers_are_never_read_as_one_of_them(one: int, other: int, mark: str) -> None:
    for call in calls("humanoid", "en", f"walk forward {one}{mark}{other} meters"):
        exact = {".": float(f"{one}.{other}")}
        if mark == "/" and 0 < one < 10 and 1 < other <= 10:
            exact["/"] = one / other
        assert call.arguments["distance"] == pytest.approx(exact.get(mark), rel=1e-4)


@given(st.text("bcdfghjklpqvwz", min_size=3, max_size=9))
def test_a_number_whose_unit_nobody_knows_is_no_distance(unit: str) -> None:
    assert calls("humanoid", "en", f"walk forward 5 {unit}") == ()
