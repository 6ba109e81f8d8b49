"""Of several robots that hear a person one answers: their messages in time that a test holds."""

import json
import random
from dataclasses import dataclass, replace

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from support.clock import HeldClock

from edgevox.core.commands import Heard, Hypothesis
from edgevox.core.errors import InvalidValue
from edgevox.core.hearers import (
    ANOTHER,
    BEAT_S,
    IDLE_BEATS,
    LATEST_S,
    MAX_CHARACTERS,
    MOST_PER_S,
    MOST_ROBOTS,
    Hearers,
    UtteranceHeard,
    read_claim,
)

BEGAN_S, ENDED_S = 20.0, 22.0
"""An utterance, after everybody has got to know everybody."""
AGREED_S = 0.3
NAMES = ("Rosie", "Max", "Bender", "Wall E", "Marvin")
GO = "Go to the kitchen."


@dataclass
class Way:
    """How messages get through: seconds on the way, and the share that is lost."""

    late_s: float = 0.005
    lost: float = 0.0
    seed: int = 0


class Site:
    """Robots on one network. Time passes only in `until`."""

    def __init__(self, count: int = 3, way: Way | None = None, group: str = "hall") -> None:
        self.clock, self.way = HeldClock(0.0), way or Way()
        self.robots = [
            Hearers(name, group, self.clock, f"{at:08x}") for at, name in enumerate(NAMES[:count])
        ]
        self.dead: set[int] = set()
        self.frozen: dict[int, list[str]] = {}
        self.settled: dict[int, list[tuple[str, float]]] = {at: [] for at in range(count)}
        self._luck = random.Random(self.way.seed)
        for at, robot in enumerate(self.robots):
            robot.send = lambda text, at=at: self._send(at, text)
            self._beat(at, 0.007 * at)

    def until(self, now_s: float) -> None:
        self.clock.advance(now_s - self.clock.now_s)

    def hears(self, at: int, level_db: float, words_s: float = 0.5, text: str = GO, **more):
        """This robot claims the utterance 0.2 s after its end, and knows its words later."""
        began_s, ended_s = more.pop("span", (BEGAN_S, ENDED_S))
        utterance = UtteranceHeard(began_s, ended_s, level_db, **more)
        heard = Heard(text, ended_s, began_s=began_s)
        self.clock.at(ended_s + 0.2, lambda: self._do(at, lambda: self.robots[at].heard(utterance)))
        self.clock.at(ended_s + 0.2 + words_s, lambda: self._do(at, lambda: self._words(at, heard)))
        return heard

    def dies(self, at: int, when_s: float) -> None:
        self.clock.at(when_s, lambda: self.dead.add(at))

    def answering(self) -> list[int]:
        """Who answered."""
        return [at for at, told in self.settled.items() if any(other == "" for other, _ in told)]

    def _do(self, at: int, what) -> None:
        if at not in self.dead and at not in self.frozen:
            what()

    def _words(self, at: int, heard: Heard) -> None:
        settle = lambda other: self.settled[at].append((other, self.clock.now_s))  # noqa: E731
        self.robots[at].settle(heard, settle)

    def _beat(self, at: int, when_s: float) -> None:
        def beat() -> None:
            self._do(at, self.robots[at].beat)
            self._beat(at, when_s + BEAT_S)

        self.clock.at(when_s, beat)

    def _send(self, sender: int, text: str) -> None:
        for at in range(len(self.robots)):
            if sender in self.dead or (at != sender and self._luck.random() < self.way.lost):
                continue
            late_s = 0.001 if at == sender else self.way.late_s
            self.clock.at(self.clock.now_s + late_s, lambda at=at: self._arrive(at, text))

    def _arrive(self, at: int, text: str) -> None:
        if at in self.frozen:
            self.frozen[at].append(text)
        elif at not in self.dead:
            self.robots[at].hear(text)

    def thaw(self, at: int, words: Heard) -> None:
        """Go on: its words come first, then what has waited in its queue."""
        waited = self.frozen.pop(at)
        self._words(at, words)
        for text in waited[-128:]:
            self.robots[at].hear(text)


def test_the_robot_that_hears_best_answers_and_the_others_say_who_does():
    site = Site()
    for at, level_db in enumerate((12.0, 25.0, 18.0)):
        site.hears(at, level_db)
    site.until(25.0)
    assert [told[0][0] for told in site.settled.values()] == ["Max", "", "Max"]
    assert [len(told) for told in site.settled.values()] == [1, 1, 1]
    words_s = ENDED_S + 0.7
    assert all(told[0][1] - words_s < AGREED_S for told in site.settled.values())


def test_a_robot_alone_answers_in_the_same_moment():
    site = Site(count=1)
    site.hears(0, 12.0, words_s=0.0)
    site.until(25.0)
    assert site.settled[0] == [("", ENDED_S + 0.2)]


def test_robots_of_another_group_do_not_count():
    site = Site(count=1)
    other = Hearers("Max", "cellar", site.clock)
    other.send = site.robots[0].hear
    for _ in range(IDLE_BEATS):
        other.beat()
    assert site.robots[0].names == ()


def test_equally_loud_robots_agree():
    site = Site(count=5)
    for at in range(5):
        site.hears(at, 20.0)
    site.until(25.0)
    assert len(site.answering()) == 1


@pytest.mark.parametrize("text", ["Rosie, go to the kitchen.", "Go to the kitchen, Rosie!"])
def test_the_robot_that_is_named_answers_however_well_it_hears(text):
    site = Site()
    for at, level_db in enumerate((6.0, 25.0, 18.0)):
        site.hears(at, level_db, text=text)
    site.until(25.0)
    assert [told[0][0] for told in site.settled.values()] == ["", "Rosie", "Rosie"]


def test_where_a_name_may_have_been_misheard_the_named_robots_own_words_count():
    site = Site()
    site.hears(0, 6.0, words_s=0.6, text="Rosie, go to the kitchen.")
    site.hears(1, 25.0, words_s=0.4, text="Rosy, go to the kitchen.")
    site.hears(2, 18.0, words_s=0.3, text="Go to the kitchen.")
    site.until(25.0)
    assert site.answering() == [0]


def test_words_that_call_nobody_wait_for_nobody():
    site = Site()
    for at, (level_db, words_s) in enumerate([(6.0, 0.9), (25.0, 0.4), (18.0, 0.9)]):
        site.hears(at, level_db, words_s=words_s)
    site.until(25.0)
    assert site.settled[1] == [("", pytest.approx(ENDED_S + 0.2 + 0.4))]


def test_an_order_for_a_robot_that_does_not_hear_it_is_nobody_elses():
    site = Site()
    for at in (1, 2):
        site.hears(at, 20.0 + at, text="Rosie, go to the kitchen.")
    site.until(25.0)
    assert site.answering() == []
    assert [told[0][0] for at, told in site.settled.items() if at] == ["Rosie", "Rosie"]


def test_an_answer_is_for_the_robot_that_asked():
    site = Site()
    for at, level_db in enumerate((6.0, 25.0, 18.0)):
        site.hears(at, level_db, text="yes", asked=at == 2)
    site.until(25.0)
    assert site.answering() == [2]


def test_two_persons_in_two_rooms_who_speak_one_after_the_other_are_both_answered():
    site = Site(count=2)
    site.hears(0, 20.0)
    site.hears(1, 25.0, span=(ENDED_S + 0.1, ENDED_S + 1.5))
    site.until(27.0)
    assert site.answering() == [0, 1]


def test_wake_words_at_two_times_are_two_utterances():
    site = Site(count=2)
    site.hears(0, 20.0, woken_s=BEGAN_S + 0.2)
    site.hears(1, 25.0, woken_s=BEGAN_S + 1.2)
    site.until(25.0)
    assert site.answering() == [0, 1]


def test_of_two_that_hear_it_in_one_piece_and_in_two_one_answers():
    site = Site(count=2)
    site.hears(0, 25.0)
    site.hears(1, 12.0, span=(BEGAN_S, BEGAN_S + 0.9))
    site.hears(1, 11.0, span=(BEGAN_S + 1.0, ENDED_S + 0.1))
    site.until(26.0)
    assert len(site.answering()) == 1


def test_the_best_is_waited_for_while_it_looks_for_the_words():
    site = Site()
    for at, (level_db, words_s) in enumerate([(12.0, 0.2), (25.0, 1.9), (18.0, 0.4)]):
        site.hears(at, level_db, words_s=words_s)
    site.until(27.0)
    assert site.answering() == [1]


def test_one_that_finds_no_words_is_not_waited_for():
    site = Site()
    for at, level_db in enumerate((12.0, 25.0, 18.0)):
        heard = site.hears(at, level_db, words_s=0.6 if at == 1 else 0.5)
    site.until(ENDED_S + 0.65)
    site.robots[1].withdraw(heard)
    site.dead.add(1)  # its words are empty: `settle` is not called
    site.until(ENDED_S + 0.65 + AGREED_S)
    assert site.answering() == [2]


@pytest.mark.parametrize("after_s", [0.0, 0.21, 0.4, 0.65])
def test_when_the_best_dies_between_hearing_and_answering_the_next_answers_soon(after_s):
    site = Site(count=5)
    for at, level_db in enumerate((12.0, 25.0, 18.0, 22.0, 3.0)):
        site.hears(at, level_db)
    site.dies(1, ENDED_S + after_s)
    site.until(25.0)
    assert site.answering() == [3]
    late_s = site.settled[3][0][1] - max(ENDED_S + 0.7, ENDED_S + after_s)
    assert late_s <= AGREED_S + BEAT_S


def test_one_that_was_frozen_keeps_silent_when_it_goes_on():
    site = Site()
    heard = [site.hears(at, level_db) for at, level_db in enumerate((12.0, 25.0, 18.0))]
    site.until(ENDED_S + 0.6)
    site.frozen[1] = []
    site.until(ENDED_S + 4.0)
    assert site.answering() == [2]
    site.thaw(1, heard[1])
    site.until(ENDED_S + 6.0)
    assert site.answering() == [2]
    assert site.settled[1][0][0] == "Bender"


def test_one_whose_executor_hangs_leaves_it_to_the_others():
    site = Site()
    for at, level_db in enumerate((12.0, 25.0, 18.0)):
        site.hears(at, level_db)
    site.until(ENDED_S + 0.6)
    hear, site.robots[1].hear = site.robots[1].hear, lambda _: None
    site.until(ENDED_S + 0.7 + LATEST_S + 0.2)
    site.robots[1].hear = hear
    assert site.answering() == [2]
    assert site.settled[1][0][0] == ANOTHER


def test_what_was_spoken_on_stays_with_the_robot_that_has_it():
    site = Site(count=2)
    site.hears(0, 25.0)
    site.hears(1, 12.0)
    site.hears(0, 15.0, span=(BEGAN_S, ENDED_S + 2.0))
    site.hears(1, 19.0, span=(BEGAN_S, ENDED_S + 2.0))
    site.until(28.0)
    assert [[other for other, _ in told] for told in site.settled.values()] == [
        ["", ""],
        ["Rosie", "Rosie"],
    ]


def test_the_next_utterance_is_decided_anew():
    site = Site(count=2)
    for began_s, best in ((BEGAN_S, 0), (BEGAN_S + 3.0, 1), (BEGAN_S + 6.0, 0)):
        for at in range(2):
            site.hears(at, 20.0 + 3 * (at == best), span=(began_s, began_s + 1.5))
    site.until(35.0)
    assert [[other == "" for other, _ in told] for told in site.settled.values()] == [
        [True, False, True],
        [False, True, False],
    ]


def test_what_another_robot_says_is_answered_by_nobody():
    site = Site()
    site.clock.at(BEGAN_S, lambda: site.robots[0].says("I am going to the kitchen."))
    site.clock.at(BEGAN_S, lambda: site.robots[0].speaks(True))
    site.clock.at(ENDED_S, lambda: site.robots[0].speaks(False))
    for at in (1, 2):
        site.hears(at, 20.0 + at, text="I am going to the kitten.")
    site.until(25.0)
    assert site.answering() == []
    assert [told[0][0] for told in site.settled.values() if told] == ["Rosie", "Rosie"]


@pytest.mark.parametrize(
    ("text", "span"),
    [
        ("Where is your battery?", (BEGAN_S, ENDED_S)),
        ("I am going to the kitchen.", (ENDED_S + 0.1, ENDED_S + 1.5)),
    ],
)
def test_a_person_who_speaks_while_a_robot_speaks_or_after_it_is_answered(text, span):
    site = Site()
    site.clock.at(BEGAN_S, lambda: site.robots[0].says("I am going to the kitchen."))
    site.clock.at(BEGAN_S, lambda: site.robots[0].speaks(True))
    site.clock.at(ENDED_S, lambda: site.robots[0].speaks(False))
    for at in (1, 2):
        site.hears(at, 20.0 + at, text=text, span=span)
    site.until(27.0)
    assert site.answering() == [2]


def test_a_robot_that_leaves_or_falls_silent_is_not_counted_any_more():
    site = Site()
    site.until(BEGAN_S)
    assert site.robots[0].names == ("Bender", "Max")
    site.robots[1].leave()
    site.dead |= {1, 2}
    site.until(BEGAN_S + 0.5)
    assert site.robots[0].names == ("Bender",)
    site.until(BEGAN_S + 6.0)
    assert site.robots[0].names == ()


_LEVELS = st.lists(st.sampled_from((3.0, 9.0, 9.0, 15.0, 21.0, 30.0)), min_size=2, max_size=5)


@given(
    levels=_LEVELS,
    words_s=st.lists(st.floats(0.05, 4.0), min_size=5, max_size=5),
    shifts_s=st.lists(st.floats(-0.15, 0.15), min_size=5, max_size=5),
    late_s=st.sampled_from((0.001, 0.02, 0.06)),
    lost=st.sampled_from((0.0, 0.05)),
    seed=st.integers(0, 1000),
    dies=st.none() | st.tuples(st.integers(0, 4), st.floats(-0.3, 1.5)),
)
@example([9.0, 9.0], [0.5] * 5, [0.0] * 5, 0.06, 0.0, 0, None)
@example([9.0, 9.0], [0.9, 2.8] * 3, [0.0] * 5, 0.02, 0.0, 0, None)
def test_never_two_and_never_none(levels, words_s, shifts_s, late_s, lost, seed, dies):
    site = Site(len(levels), Way(late_s, lost, seed))
    for at, level_db in enumerate(levels):
        span = (BEGAN_S + shifts_s[at], ENDED_S + shifts_s[-1 - at])
        site.hears(at, level_db, words_s=words_s[at], span=span)
    if dies and dies[0] < len(levels):
        site.dies(dies[0], ENDED_S + dies[1])
    site.until(40.0)
    assert site.answering()
    assert len(set(site.answering()) - site.dead) <= 1


@pytest.mark.parametrize(
    "change",
    [
        {"id": "nobody"},
        {"name": "x" * 41},
        {"ago_ms": -5},
        {"lasted_ms": 40_000},
        {"level_db": 1e9},
        {"level_db": "loud"},
        {"answers": "all"},
        {"utterance": -1},
    ],
)
def test_a_claim_that_is_none_is_refused(change):
    claim = {"id": "0123abcd", "name": "Max", "group": "hall", "beat": 3}
    assert read_claim(json.dumps(claim)).name == "Max"
    with pytest.raises(InvalidValue, match="hearers"):
        read_claim(json.dumps(claim | change))


def test_a_long_message_and_a_flood_are_not_read():
    with pytest.raises(InvalidValue, match="characters"):
        read_claim(" " * (MAX_CHARACTERS + 1))
    robot = Hearers("Rosie", "hall", HeldClock(5.0))
    for number in range(MOST_PER_S + 10):
        claim = {"id": f"{number:08x}", "name": "Max", "group": "hall", "beat": 3}
        robot.hear(json.dumps(claim))
    assert robot.dropped == 10
    assert len(robot.names) == MOST_ROBOTS


def test_a_stranger_can_silence_a_robot_for_an_utterance_and_not_for_the_next():
    site = Site(count=1)
    site.hears(0, 20.0)
    site.hears(0, 20.0, span=(ENDED_S + 2.0, ENDED_S + 3.5))
    site.until(ENDED_S + 0.1)
    lies = {"id": "0123abcd", "name": "Eve", "group": "hall", "beat": 3, "utterance": 1}
    lies |= {"lasted_ms": 2000, "ago_ms": 100, "answers": "0123abcd", "level_db": 99.0}
    site.robots[0].hear(json.dumps(lies))
    site.until(30.0)
    assert [other for other, _ in site.settled[0]] == ["Eve", ""]


def test_the_name_is_left_out_of_the_other_hypotheses():
    robot = Hearers("Rosie", "hall")
    heard = Heard("Rosie, go.", 3.0, others=(Hypothesis("Rosie, no.", 0.2, 0.5),))
    assert robot.own_words(heard) == replace(
        heard, text="go.", others=(Hypothesis("no.", 0.2, 0.5),)
    )
