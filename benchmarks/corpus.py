"""What the product makes of the sentences of strangers: what is right, moves wrongly, is asked.

Each sentence goes the way that a spoken one goes: stop words, templates of skills and of programs,
readings and their judge.
A language model is not asked, since it only answers in words; what the default one would do if it
were let is told of a sample. "asked" is what is asked back; a
wrong motion is one that is begun unasked and is none of the right outcomes.
"""

import resource
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from figures import Figure, Measured, NotHere

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from corpus_robots import is_right, skills_of_robots
from corpus_sentences import Sentence, read_corpus

from edgevox.agent.intents import Recogniser, Refused, Understood
from edgevox.agent.llm.base import LanguageModel, Message, ModelFailed
from edgevox.agent.llm.factory import load_model
from edgevox.agent.mind import ANSWER_TOKENS
from edgevox.agent.nlu.decider import Decider, Readings
from edgevox.agent.nlu.encoder import ENCODER, Encoder
from edgevox.agent.nlu.judge import ASK_FROM, SURE_FROM, read_head
from edgevox.agent.programs.program import Program, calls_of
from edgevox.agent.programs.reader import Plain, ProgramReader
from edgevox.agent.safety import find_stop_word
from edgevox.agent.skills import STOP, Call
from edgevox.agent.toolcalls import Protocol
from edgevox.apps.robots import ROBOTS
from edgevox.core.cancel import CancelToken
from edgevox.models import ModelMissing, locate

MODEL = "qwen2.5-coder-0.5b-instruct"
TABLE = "What becomes of what strangers say"
WANTED_RIGHT, WANTED_RIGHT_ELSEWHERE, WANTED_ASKED = 95.0, 85.0, 5.0
WANTED_MEDIAN_S, WANTED_SLOWEST_S, WANTED_TEMPLATE_S = 0.5, 1.5, 0.002
SAMPLE = 150
"""Of the tuning half that a language model alone is given: it takes a second a sentence."""


@dataclass(frozen=True, slots=True)
class Told:
    """What became of a sentence."""

    sentence: Sentence
    calls: tuple[Call, ...]
    confidence: float
    stage: str
    seconds: float

    @property
    def asked(self) -> bool:
        """Whether somebody is asked before anything is done."""
        return bool(self.calls) and self.confidence < SURE_FROM

    @property
    def right(self) -> bool:
        """Whether it did what was meant, or rightly nothing."""
        return is_right(self.sentence, self.sentence.robot, () if self.asked else self.calls)

    @property
    def moved_wrongly(self) -> bool:
        """Whether it began a motion, unasked, that nobody wanted."""
        skills = skills_of_robots()[self.sentence.robot]
        moves = any(one.skill in skills and skills[one.skill].drives for one in self.calls)
        return moves and not self.asked and not self.right


class Product:
    """Understands as the product does; without a decider as where the encoder is missing."""

    def __init__(self, decider: Decider | None) -> None:
        self._decider = decider
        self._ways: dict[tuple[str, str], tuple[Recogniser, ProgramReader, Readings]] = {}

    def tell(self, sentence: Sentence) -> Told:
        """What becomes of a sentence."""
        way = self._way(sentence.robot, sentence.language)
        started = time.perf_counter()
        calls, confidence, stage = self._understand(sentence, *way)
        return Told(sentence, calls, confidence, stage, time.perf_counter() - started)

    def _understand(
        self,
        sentence: Sentence,
        recogniser: Recogniser,
        programs: ProgramReader,
        readings: Readings,
    ) -> tuple[tuple[Call, ...], float, str]:
        if find_stop_word(sentence.language, sentence.says):
            return (Call(STOP),), 1.0, "stop word"
        found = recogniser.recognise(sentence.says)
        if isinstance(found, Understood):
            return found.calls, 1.0, "template"
        plain = partial(_plain, recogniser)
        program, sure = programs.understand(
            sentence.says, plain, partial(self._free, plain, readings)
        )
        if isinstance(program, Program):
            return calls_of(program), 1.0 if sure else ASK_FROM, "program"
        if self._decider is None:
            return (), 1.0, "none"
        decision = self._decider.decide(readings.of(sentence.says), sentence.says)
        if decision is None:
            return (), 1.0, "none"
        skills = skills_of_robots()[sentence.robot]
        if program and any(skills[call.skill].drives for call in decision.calls):
            return (), 1.0, "none"  # for later, or never
        return decision.calls, decision.confidence, "reading"

    def _free(self, plain: Plain, readings: Readings, text: str) -> Sequence[Call] | Refused | None:
        found = plain(text)
        if isinstance(found, Sequence) or self._decider is None:
            return found
        decision = self._decider.decide(readings.of(text), text)
        return decision.calls if decision and decision.sure else found

    def _way(self, robot: str, language: str) -> tuple[Recogniser, ProgramReader, Readings]:
        if (robot, language) not in self._ways:
            skills = skills_of_robots()[robot]
            readings = Readings(skills, language)
            readings.of("ready")
            recogniser = Recogniser(skills, language)
            self._ways[robot, language] = recogniser, ProgramReader(language), readings
        return self._ways[robot, language]


def _plain(recogniser: Recogniser, text: str) -> Sequence[Call] | Refused | None:
    found = recogniser.recognise(text)
    return found.calls if isinstance(found, Understood) else found


def open_decider() -> Decider:
    """The product's. Raises `NotHere`."""
    try:
        return Decider(Encoder(locate(ENCODER)), read_head())
    except ModelMissing as error:
        raise NotHere(str(error)) from error


def measure(quick: bool = False) -> Measured:
    """The corpus through templates alone and through the whole, the halves apart."""
    sentences = read_corpus()[:: 10 if quick else 1]
    figures = []
    for name, decider in (("templates", None), ("whole", open_decider())):
        tell = Product(decider).tell
        told = [tell(one) for one in sentences]
        for half, held in (("tuning", False), ("held_out", True)):
            chosen = [one for one in told if one.sentence.held_out is held]
            figures += _figures(f"{name}.{half}", f"{name}, {half.replace('_', ' ')}", chosen)
    figures += _model_alone(sample(sentences, 15 if quick else SAMPLE))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    figures.append(
        Figure(id="memory", table=TABLE, what="memory, without speech and language model",
               value=round(memory), unit="MB")
    )  # fmt: skip
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


def _model_alone(sentences: Sequence[Sentence]) -> Iterator[Figure]:
    """What the default model would do under a grammar alone, if nothing judged what it calls."""
    try:
        model = load_model(locate(MODEL))
    except (ModelFailed, ModelMissing) as error:
        raise NotHere(str(error)) from error
    told = through_model_alone(model, sentences)
    model.close()
    yield from _shares("model", "templates and the 0.5B alone, of the tuning half", "", told)


def through_model_alone(model: LanguageModel, sentences: Iterable[Sentence]) -> list[Told]:
    """What templates and then a language model with a grammar would do, without a judge."""
    product, told = Product(None), []
    for one in sentences:
        first = product.tell(one)
        if first.stage != "none":
            told.append(first)
            continue
        skills = skills_of_robots()[one.robot]
        protocol = Protocol(ROBOTS[one.robot].instructions, skills, language=one.language)
        chat = [*protocol.opening, Message("user", protocol.prepare(one.says))]
        parser, started = protocol.parser(), time.perf_counter()
        for piece in model.generate(
            chat, grammar=protocol.grammar, max_tokens=ANSWER_TOKENS, token=CancelToken()
        ):
            parser.feed(piece)
        calls, seconds = tuple(parser.finish()), time.perf_counter() - started
        told.append(Told(one, calls, 1.0, "model", seconds))
    return told


def sample(sentences: Sequence[Sentence], size: int) -> list[Sentence]:
    """Some of the tuning half, robot by robot, so that a model keeps what it read of one."""
    english = [one for one in sentences if one.language == "en" and not one.held_out]
    return sorted(english[:: max(1, len(english) // size)], key=lambda one: one.robot)
