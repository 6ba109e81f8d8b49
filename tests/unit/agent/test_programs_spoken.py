"""Every sentence template of programs, in every language, is understood and stops nobody."""

import random
from functools import cache

import pytest
from few_languages import few
from support.bodies import BODIES, written

from edgevox.agent.nlu.meaning import (
    After,
    Arrived,
    BatteryBelow,
    Do,
    Pause,
    Program,
    Repeat,
    Return,
    Say,
    Steps,
    When,
)
from edgevox.agent.nlu.order_reader import ProgramReader, Unclear
from edgevox.agent.nlu.templates import Recogniser, RefusedCommand, Understood
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.stop.words import SafetyWords
from edgevox.core.languages import LANGUAGES

SAMPLES = 4
NUMBERS = {
    "count": "3", "seconds": "10", "minutes": "5", "hours": "2", "percent": "20", "time": "17:30",
}  # fmt: skip
ORDERS = {
    "en": "go to the kitchen",
    "de": "fahr in die Küche",
    "fr": "va dans la cuisine",
    "es": "ve a la cocina",
    "it": "vai in cucina",
    "pt": "vá para a cozinha",
    "nl": "ga naar de keuken",
    "pl": "idź do kuchni",
    "ru": "иди в кухню",
    "tr": "mutfağa git",
    "ar": "اذهب إلى المطبخ",
    "hi": "रसोई में जाओ",
    "id": "pergi ke dapur",
    "vi": "đi đến bếp",
    "ja": "キッチンに行って",
    "zh": "去厨房",
}
PLACES = {
    "en": "the kitchen and the office",
    "de": "der Küche und dem Büro",
    "fr": "la cuisine et le bureau",
    "es": "la cocina y el despacho",
    "it": "la cucina e lo studio",
    "pt": "a cozinha e o escritório",
    "nl": "de keuken en het kantoor",
    "pl": "kuchnią a biurem",
    "ru": "кухней и кабинетом",
    "tr": "mutfak ile ofis",
    "ar": "المطبخ والمكتب",
    "hi": "रसोई और दफ़्तर",
    "id": "dapur dan kantor",
    "vi": "bếp và văn phòng",
    "ja": "キッチンと書斎",
    "zh": "厨房和书房",
}
KINDS = ("low", "wait", "after", "until", "times", "arrived", "saying", "back", "patrol", "clock")


def worded(code: str, template: str, source: random.Random) -> str:
    """A sentence that this template stands for, by chance."""
    book = phrasebook(code)
    cut = ORDERS[code].index(" ") if book.hearing.spaced else len(ORDERS[code]) // 2
    whole = "{rest}" not in template
    words = {
        "order": ORDERS[code] if whole else ORDERS[code][:cut].strip(),
        "rest": ORDERS[code][cut:].strip(),
        "next": ORDERS[code],
        "words": "abc",
        "places": PLACES[code],
        **NUMBERS,
    }

    return written(template, book.programs.rules, words.__getitem__, source)


@cache
def reader(code: str) -> tuple[Recogniser, ProgramReader]:
    return Recogniser(BODIES["apartment"], code), ProgramReader(code)


def read(code: str, sentence: str) -> object:
    recogniser, programs = reader(code)

    def plain(text: str) -> object:
        found = recogniser.recognise(text)
        return found.calls if isinstance(found, Understood) else found

    return programs.read(sentence, plain)


def is_one(code: str, kind: str, program: object) -> bool:
    match kind, program:
        case "low", When(condition=BatteryBelow(percent=20.0)):
            return True
        case "after", After(delay_s=delay_s):
            return delay_s in (10.0, 300.0, 310.0, 7200.0, 7500.0)
        case "wait", Steps(steps=(Do(), Pause(seconds=seconds), *_)):
            return seconds in (10.0, 300.0, 310.0, 7200.0, 7500.0)
        case (("until" | "patrol"), Repeat(count=None)):
            return True
        case "times", Repeat(count=3.0):
            return True
        case "arrived", Steps() | When(condition=Arrived()):
            return True
        case "saying", Steps(steps=(*_, Say(words="abc"))):
            return True
        case "back", Steps(steps=(*_, Return())):
            return True
        case "clock", RefusedCommand(reason=reason):
            return reason == phrasebook(code).say("program_clock")
    return False


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("code", few(LANGUAGES))
def test_what_a_template_stands_for_is_understood_and_stops_nobody(code, kind):
    templates = phrasebook(code).programs.templates[kind]
    source, safety = random.Random(7), SafetyWords(code)
    assert templates
    for sentence in dict.fromkeys(worded(code, one, source) for one in templates * SAMPLES):
        assert safety.find(sentence) is None, sentence
        program = read(code, sentence)
        assert is_one(code, kind, program), (sentence, program)


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_language_has_every_kind_of_template_and_name(code):
    english, book = phrasebook(ENGLISH).programs, phrasebook(code).programs
    assert book.templates.keys() == english.templates.keys()
    assert book.names.keys() == english.names.keys()
    assert "{place}" in book.go


ENGLISH_WORDS = [
    ("in half an hour, go to the office", After),
    ("go to the office in an hour and a half", After),
    ("in ninety seconds say the tea is ready", After),
    ("go to the kitchen twice", Repeat),
    ("go two times to the kitchen", Repeat),
    ("go to the kitchen, wait there for ten seconds and come back", Steps),
    ("go to the kitchen, stay there for ten seconds, then go to the office", Steps),
    ("go to the kitchen and stay there for ten seconds", Steps),
    (
        "go to the kitchen, wait ten seconds, go to the office, then to the bedroom",
        type(None),
    ),
    ("patrol the kitchen, the office and the bedroom", Repeat),
    ("drive to the kitchen over and over again", Repeat),
    ("go to the kitchen when your battery falls under 15 percent", When),
    ("In five minutes my wife comes home.", Unclear),
    ("in an hour, the stove should be checked", Unclear),
    ("I was there three times", type(None)),
    ("the office is five minutes away", type(None)),
    ("what is seven times eight", type(None)),
    ("say hello", type(None)),
    ("I walked for two hours yesterday", type(None)),
]


@pytest.mark.parametrize(("sentence", "kind"), ENGLISH_WORDS)
def test_english_sentences_are_programs_or_none(sentence, kind):
    assert isinstance(read("en", sentence), kind)


NUMBERED = [
    ("de", "fahr in zwanzig Minuten ins Büro", 1200.0),
    ("de", "in einer halben Stunde fahr ins Büro", 1800.0),
    ("ja", "十五分後にキッチンに行って", 900.0),
    ("zh", "二十五分钟后去厨房", 1500.0),
    ("zh", "半小时后去厨房", 1800.0),
    ("ru", "через двадцать пять минут иди в кухню", 1500.0),
    ("fr", "dans une demi-heure, va dans la cuisine", 1800.0),
    ("ar", "بعد خمس دقائق اذهب إلى المطبخ", 300.0),
    ("en", "in 1/2 a minute, go to the office", 30.0),
    ("en", "in a minute and a half go to the office", 90.0),
    ("en", "in a couple of minutes go to the office", 120.0),
    ("en", "in three quarters of an hour go to the office", 2700.0),
    ("en", "in 90s go to the office", 90.0),
    ("en", "go to the office in 2min", 120.0),
    ("en", "in twenty five minutes go to the office", 1500.0),
]


@pytest.mark.parametrize(("code", "sentence", "delay_s"), NUMBERED)
def test_numbers_are_understood_as_they_are_said(code, sentence, delay_s):
    program = read(code, sentence)
    assert isinstance(program, After)
    assert program.delay_s == delay_s


CLOCKS = [
    "at 17:30 go to the kitchen",
    "at half past five, go to the kitchen",
    "go to the kitchen at noon please",
    "every hour go to the kitchen",
    "go to the kitchen every ten minutes",
]


@pytest.mark.parametrize("sentence", CLOCKS)
def test_an_order_for_a_time_of_day_is_declined_by_name(sentence):
    refused = read("en", sentence)
    assert isinstance(refused, RefusedCommand)
    assert refused.reason == phrasebook("en").say("program_clock")


@pytest.mark.parametrize("sentence", ["at 17:30 what is on television", "what happens every hour"])
def test_what_is_no_order_is_not_declined(sentence):
    assert not isinstance(read("en", sentence), RefusedCommand)


def test_wrappers_may_stand_around_each_other():
    program = read("en", "in five minutes, go to the kitchen and back three times")
    assert isinstance(program, After)
    inner: Program = program.program
    assert isinstance(inner, Repeat)
    assert inner.count == 3
    assert isinstance(inner.program, Steps)


STOPS = [
    ("en", "until I say stop, stop"),
    ("en", "until I say stop stop"),
    ("en", "stop until I say go"),
    ("en", "don't move until I say stop"),
    ("en", "I say stop until you stop"),
    ("en", "somebody says stop"),
    ("en", "patrol until I say stop. Stop!"),
    ("de", "bis ich stopp sage, stopp"),
    ("de", "bleib stehen bis ich was sage"),
    ("es", "hasta que diga para, para"),
    ("fr", "arrête jusqu'à ce que je te dise"),
    ("ja", "止まれと言うまで、止まれ"),
    ("tr", "ben dur diyene kadar dur"),
    ("zh", "直到我说停，停"),
]


@pytest.mark.parametrize(("code", "sentence"), STOPS)
def test_until_i_say_stop_hides_no_stop(code, sentence):
    assert SafetyWords(code).find(sentence)


@pytest.mark.parametrize(
    "sentence",
    [
        "go to the kitchen in five minutes three times",
        "go to the kitchen and when you are there, in five minutes go to the office",
    ],
)
def test_nothing_that_waits_stands_inside_what_is_done_at_once(sentence):
    assert not isinstance(read("en", sentence), Program)
