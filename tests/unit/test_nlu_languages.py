"""In each of the sixteen languages: what is denied, told or asked moves nothing, and orders do."""

from dataclasses import fields
from functools import lru_cache

import pytest
from corpus_robots import skills_of_robots

from edgevox.agent.nlu.decider import Judged, Readings
from edgevox.agent.nlu.function_words import FunctionWords, words_of
from edgevox.agent.skills import Call
from edgevox.core.languages import LANGUAGES

NEEDLESS = {"ja": {"reversals"}}
"""Japanese says in the verb what is done first."""
OWN = {"wishes", "reasons", "plans", "pronouns", "linking", "gerunds", "copulas", "misheard"}
"""What helps to read more orders, where it is listed, and holds nothing back where it is not."""
KITCHEN = (Call("navigate_to", {"room": "kitchen"}),)


@lru_cache
def readings(robot: str, language: str) -> Readings:
    return Readings(skills_of_robots()[robot], language)


def read(language: str, text: str, robot: str = "robot-apartment") -> Judged | None:
    return readings(robot, language).of(text)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_lists_every_class_of_function_words(language: str) -> None:
    words = words_of(language)
    missing = {one.name for one in fields(FunctionWords) if not getattr(words, one.name)}

    assert missing - OWN - NEEDLESS.get(language, set()) == set()


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("ar", "لا تتحرك نحو المطبخ اليوم"),
        ("hi", "आज रसोई में कदम मत रखना"),
        ("id", "hari ini jangan dekat dekat dapur"),
        ("it", "oggi in cucina non ci si mette piede"),
        ("nl", "vandaag hoef je de keuken niet in"),
        ("pl", "dziś nie wjeżdżaj do kuchni"),
        ("pt", "hoje não quero ninguém na cozinha"),
        ("ru", "сегодня на кухню не заезжай"),
        ("tr", "bugün mutfağa uğrama"),
        ("vi", "hôm nay đừng bén mảng tới nhà bếp"),
        ("it", "ieri Paolo diceva vai in cucina"),
        ("pt", "a Rita disse vai para a cozinha"),
        ("nl", "Anna zei rij naar de keuken"),
        ("pl", "Ania powiedziała jedź do kuchni"),
        ("ru", "Аня сказала поезжай на кухню"),
        ("tr", "Ayşe mutfağa git diyor"),
        ("ar", "قال أحمد اذهب إلى المطبخ"),
        ("hi", "राजू बोला रसोई में जाओ"),
        ("id", "kata Budi pergi ke dapur"),
        ("vi", "Lan bảo đi vào nhà bếp"),
        ("it", "quando vai in cucina?"),
        ("pt", "quem vai para a cozinha?"),
        ("nl", "wie gaat er naar de keuken?"),
        ("pl", "kto jedzie do kuchni?"),
        ("ru", "кто поедет на кухню?"),
        ("tr", "mutfağa kim gidiyor?"),
        ("ar", "متى تذهب إلى المطبخ؟"),
        ("hi", "रसोई में कौन जाएगा?"),
        ("id", "siapa pergi ke dapur?"),
        ("vi", "ai đi vào nhà bếp?"),
    ],
)
def test_denials_reports_and_questions_are_held_back(language: str, text: str) -> None:
    judged = read(language, text)

    assert judged is None or judged.held_back


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("ar", "إلى المطبخ بسرعة يا صديقي"),
        ("hi", "रसोई में फटाफट आओ"),
        ("id", "ke dapur dong, cepetan"),
        ("it", "in cucina, svelto"),
        ("nl", "naar de keuken, hup"),
        ("pl", "do kuchni, migiem"),
        ("pt", "pra cozinha, depressa"),
        ("ru", "на кухню, живо"),
        ("tr", "hadi mutfağa"),
        ("vi", "vào bếp nhanh lên nhé"),
        ("nl", "zou je naar de keuken willen gaan?"),
        ("pl", "czy mógłbyś pojechać do kuchni?"),
        ("ru", "не мог бы ты поехать на кухню?"),
    ],
)
def test_short_and_polite_orders_are_read_as_wanted(language: str, text: str) -> None:
    judged = read(language, text)

    assert judged is not None
    assert judged.reading.calls == KITCHEN
    assert not judged.held_back
    assert not judged.doubted


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("ar", "المطبخ هناك"),
        ("en", "the kitchen's over there"),
        ("en", "The living room's in front of you."),
        ("en", "the kitchen is over there"),
        ("en", "over there is the kitchen"),
        ("en", "there's the office"),
        ("es", "la cocina está ahí"),
        ("fr", "la cuisine est là"),
        ("id", "dapur di sini"),
        ("ja", "キッチンはこちらです"),
        ("ru", "кухня там"),
        ("tr", "mutfak burada"),
        ("zh", "厨房在那边"),
    ],
)
def test_saying_where_a_room_is_does_not_say_to_go_there(language: str, text: str) -> None:
    judged = read(language, text)

    assert judged is not None
    assert judged.doubted


@pytest.mark.parametrize(
    "text",
    [
        "let's go to the kitchen",
        "go to the kitchen, let's see",
        "next waypoint is the kitchen, proceed",
    ],
)
def test_what_looks_like_telling_of_a_room_is_an_order(text: str) -> None:
    judged = read("en", text)

    assert judged is not None
    assert judged.reading.calls == KITCHEN
    assert not judged.doubted


def test_a_denial_counts_beside_the_english_name_of_a_room() -> None:
    judged = read("de", "nicht kitchen")

    assert judged is not None
    assert judged.held_back


@pytest.mark.parametrize(
    ("language", "text"),
    [("de", "drehe dich dreißig zwo nach links"), ("en", "turn left 40 score degrees")],
)
def test_a_number_that_may_go_on_in_an_unknown_word_is_doubted(language: str, text: str) -> None:
    judged = read(language, text, "robot-humanoid")

    assert judged is None or judged.doubted


def test_marks_within_a_word_do_not_part_it() -> None:
    judged = read("hi", "कृपया रसोई में जाओ")

    assert judged is not None
    assert judged.reading.tokens == ("कृपया", "रसोई", "में", "जाओ")
    assert judged.evidence["strange"] == 0
