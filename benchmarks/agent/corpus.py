"""What the product makes of strangers' sentences: right, wrong motions, asked back.

Each sentence passes stop words, templates of skills and programs, and readings with their judge; no
language model takes part. A wrong motion begins unasked and is none of the right outcomes. The last
table shows the judge's confidence in readings of the held-out half: from 0.5 on it asks, from 0.8
on it acts.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from corpus_robots import is_right, skills_of_robots
from corpus_sentences import Sentence, read_corpus

from benchmarks.core.calibration import calibrated
from benchmarks.core.figures import Figure, Measured, NotHere
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder import ENCODER, Encoder
from edgevox.agent.nlu.head import Head, read_head
from edgevox.agent.nlu.judging import Judged, Readings
from edgevox.agent.nlu.meaning import ASK_FROM, SURE_FROM, Program, calls_of
from edgevox.agent.nlu.order_reader import Plain, ProgramReader
from edgevox.agent.nlu.templates import Recogniser, RefusedCommand, Understood
from edgevox.agent.skills import STOP, Call, Skill
from edgevox.agent.stop.words import find_stop_word
from edgevox.models import ModelMissing, locate

TABLE = "What becomes of what strangers say"
WANTED_RIGHT, WANTED_RIGHT_ELSEWHERE, WANTED_ASKED = 95.0, 85.0, 5.0
WANTED_MEDIAN_S, WANTED_SLOWEST_S, WANTED_TEMPLATE_S = 0.5, 1.5, 0.002


@dataclass(frozen=True, slots=True)
class Meant:
    """What a sentence was taken for, and how sure that was.

    `weighed` is how sure the judge was of a reading, even if too little to do it or to ask.
    """

    calls: tuple[Call, ...]
    confidence: float
    stage: str
    weighed: tuple[tuple[Call, ...], float] | None = None


@dataclass(frozen=True, slots=True)
class Told:
    """What became of a sentence."""

    sentence: Sentence
    calls: tuple[Call, ...]
    confidence: float
    stage: str
    seconds: float
    weighed: tuple[float, bool] | None = None
    """The confidence in its reading, and whether that was what was meant."""

    @property
    def asked(self) -> bool:
        """Whether somebody is asked before anything is done: what drives or lasts, where it is not
        sure.
        """
        unsure = self.confidence < SURE_FROM
        return unsure and any(one.drives or one.lasting for one in self._skills)

    @property
    def right(self) -> bool:
        """Whether it did what was meant, or rightly nothing."""
        done = () if self.asked else self.calls
        return is_right(self.sentence, self.sentence.robot, done)

    @property
    def moved_wrongly(self) -> bool:
        """Whether it began a motion, unasked, that nobody wanted."""
        drives = any(one.drives for one in self._skills)
        return drives and not self.asked and not self.right

    @property
    def _skills(self) -> list[Skill]:
        skills = skills_of_robots()[self.sentence.robot]
        return [skills[one.skill] for one in self.calls if one.skill in skills]


class Judge:
    """The product's, and how sure it is of what it does not even ask about."""

    def __init__(self, encoder: Encoder, head: Head) -> None:
        self._encoder, self._head = encoder, head
        self._decider = Decider(encoder, head)

    def decide(self, judged: Judged | None, says: str) -> Meant:
        """What it makes of a reading."""
        if judged is None or judged.held_back:
            return NOTHING
        decision, calls = self._decider.decide(judged, says), judged.reading.calls
        if decision is not None:
            return Meant(
                decision.calls, decision.confidence, "reading", (calls, decision.confidence)
            )
        order = self._head.order(self._encoder.features(says))
        confidence = self._head.confidence(self._head.likelihood(order, judged.evidence))
        return Meant((), 1.0, "none", (calls, confidence))


NOTHING = Meant((), 1.0, "none")


class Product:
    """Understands as the product does; without a judge as where the encoder is missing."""

    def __init__(self, judge: Judge | None) -> None:
        self._judge = judge
        self._ways: dict[tuple[str, str], tuple[Recogniser, ProgramReader, Readings]] = {}

    def tell(self, sentence: Sentence) -> Told:
        """What becomes of a sentence."""
        way = self._way(sentence.robot, sentence.language)
        started = time.perf_counter()
        meant = self._understand(sentence, *way)
        seconds, weighed = time.perf_counter() - started, None
        if meant.weighed:
            calls, confidence = meant.weighed
            weighed = confidence, is_right(sentence, sentence.robot, calls)
        return Told(sentence, meant.calls, meant.confidence, meant.stage, seconds, weighed)

    def _understand(
        self,
        sentence: Sentence,
        recogniser: Recogniser,
        programs: ProgramReader,
        readings: Readings,
    ) -> Meant:
        if find_stop_word(sentence.language, sentence.says):
            return Meant((Call(STOP),), 1.0, "stop word")
        found = recogniser.recognise(sentence.says)
        if isinstance(found, Understood):
            return Meant(found.calls, 1.0, "template")
        plain = partial(_plain, recogniser)
        program, sure = programs.understand(
            sentence.says, plain, partial(self._free, plain, readings)
        )
        if isinstance(program, Program):
            return Meant(calls_of(program), 1.0 if sure else ASK_FROM, "program")
        if self._judge is None:
            return NOTHING
        meant = self._judge.decide(readings.of(sentence.says), sentence.says)
        skills = skills_of_robots()[sentence.robot]
        if program and any(skills[call.skill].drives for call in meant.calls):
            return NOTHING  # for later, or never
        return meant

    def _free(
        self, plain: Plain, readings: Readings, text: str
    ) -> Sequence[Call] | RefusedCommand | None:
        found = plain(text)
        if isinstance(found, Sequence) or self._judge is None:
            return found
        meant = self._judge.decide(readings.of(text), text)
        return meant.calls if meant.calls and meant.confidence >= SURE_FROM else found

    def _way(self, robot: str, language: str) -> tuple[Recogniser, ProgramReader, Readings]:
        if (robot, language) not in self._ways:
            skills = skills_of_robots()[robot]
            readings = Readings(skills, language)
            readings.of("ready")
            recogniser = Recogniser(skills, language)
            self._ways[robot, language] = recogniser, ProgramReader(language), readings
        return self._ways[robot, language]


def _plain(recogniser: Recogniser, text: str) -> Sequence[Call] | RefusedCommand | None:
    found = recogniser.recognise(text)
    return found.calls if isinstance(found, Understood) else found


def open_judge() -> Judge:
    """The product's. Raises `NotHere`."""
    try:
        return Judge(Encoder(locate(ENCODER)), read_head())
    except ModelMissing as error:
        raise NotHere(str(error)) from error


def measure(quick: bool = False) -> Measured:
    """The corpus through templates alone and through the whole, the halves apart."""
    sentences = read_corpus()[:: 10 if quick else 1]
    figures = []
    for name, judge in (("templates", None), ("whole", open_judge())):
        tell = Product(judge).tell
        told = [tell(one) for one in sentences]
        for half, held in (("tuning", False), ("held_out", True)):
            chosen = [one for one in told if one.sentence.held_out is held]
            figures += _figures(f"{name}.{half}", f"{name}, {half.replace('_', ' ')}", chosen)
    weighed = [one.weighed for one in told if one.sentence.held_out and one.weighed]
    figures += calibrated(weighed)
    return Measured(figures=tuple(figures))


def _figures(identifier: str, column: str, told: Sequence[Told]) -> Iterator[Figure]:
    english = [one for one in told if one.sentence.language == "en"]
    yield from _shares(identifier, column, "", english)
    for language in sorted({one.sentence.language for one in told} - {"en"}):
        chosen = [one for one in told if one.sentence.language == language]
        yield from _shares(f"{identifier}.{language}", column, f"{language}: ", chosen,
                           WANTED_RIGHT_ELSEWHERE)  # fmt: skip
    commands = [one for one in english if one.sentence.is_command]
    yield _share(f"{identifier}.commands", column, "of commands, right", commands, _is_right)
    for stage in ("template", "program", "reading", "none"):
        samples = [one.seconds for one in told if one.stage == stage]
        if samples:
            yield Figure.of(
                f"{identifier}.time_{stage}", TABLE, f"time to decide, by {stage}", samples, "s",
                column=column, wanted=WANTED_TEMPLATE_S if stage == "template" else WANTED_MEDIAN_S,
            )  # fmt: skip
    slow = float(np.percentile([one.seconds for one in told], 95))
    yield Figure(id=f"{identifier}.p95", table=TABLE, what="95th percentile of all", column=column,
                 value=round(slow, 5), unit="s", n=len(told), wanted=WANTED_SLOWEST_S)  # fmt: skip


def _shares(
    identifier: str, column: str, prefix: str, told: Sequence[Told], wanted: float = WANTED_RIGHT
) -> Iterator[Figure]:
    yield _share(f"{identifier}.right", column, f"{prefix}right", told, _is_right, wanted=wanted)
    yield Figure(id=f"{identifier}.moved", table=TABLE, what=f"{prefix}wrong motions",
                 column=column, value=sum(one.moved_wrongly for one in told), n=len(told), wanted=0,
                 )  # fmt: skip
    yield _share(f"{identifier}.asked", column, f"{prefix}asked back", told,
                 lambda one: one.asked, most=WANTED_ASKED)  # fmt: skip


def _is_right(one: Told) -> bool:
    return one.right


def _share(
    identifier: str, column: str, what: str, told: Sequence[Told], chosen: Callable[[Told], bool],
    *, wanted: float | None = None, most: float | None = None,
) -> Figure:  # fmt: skip
    value = 100 * sum(map(chosen, told)) / max(1, len(told))
    return Figure(
        id=identifier, table=TABLE, what=what, column=column, value=round(value, 1), unit="%",
        n=max(1, len(told)), wanted=wanted if most is None else most, more_is_better=most is None,
    )  # fmt: skip
