"""A robot for the benchmark of noise: what it hears in a sound, and what it would do about it."""

from collections.abc import Iterator, Sequence
from enum import Enum
from functools import cached_property

from corpus_robots import skills_of_robots, whole
from listener_rig import frames

from benchmarks.core.figures import Figure
from edgevox.agent.agents import Agent
from edgevox.agent.nlu.hearing.wordings import hearing_prompt
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.turn import Turn
from edgevox.apps.agent.models import open_decider, open_phonemes
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Way
from edgevox.models import locate
from edgevox.voice.audio import Samples
from edgevox.voice.stt.speech_to_text import Transcript
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.utterance_end import Endpointer, SpeechEnded
from edgevox.voice.vad import open_vad

MODEL = "whisper-tiny.en"


class Outcome(Enum):
    """What becomes of a command, the worst first."""

    WRONG = "wrong motions"
    RIGHT = "right"
    ASKED = "asked back"
    NOTHING = "nothing, or an answer"


def outcome_figure(outcome: Outcome, number: int, of: int, **more: object) -> Figure:
    """How many of so many commands ended so: wrong motions are counted, all else is a share."""
    wrong = outcome is Outcome.WRONG
    return Figure.model_validate(
        {
            "value": number if wrong else round(100 * number / of, 1),
            "unit": "" if wrong else "%",
            "n": of,
            "more_is_better": outcome is Outcome.RIGHT,
            **more,
        }
    )


class Robot:
    """What one robot hears and understands, as the product puts it together."""

    def __init__(self, name: str, model: str = MODEL, skills: SkillSet | None = None) -> None:
        self.skills = skills or skills_of_robots()[name]
        prompt = hearing_prompt(self.skills.values(), phrasebook("en"))
        self._path = locate(model)
        self.whisper = Whisper(lambda _: self._path, prompt_of=lambda _: prompt)
        self._bus, self._clock = Bus(), SystemClock()

    def speak(self, language: str) -> None:
        """Be talked to in another language."""
        self.interpreter.set_language(language)

    def hear(self, sound: Samples) -> list[Transcript]:
        """The words of each utterance in a sound, and how sure they are."""
        return [said for one in utterances(sound) if (said := self.hear_out(one)).text]

    def hear_out(self, sound: Samples) -> Transcript:
        """The same of a sound that is taken for an utterance, whatever it is."""
        return self.whisper.transcribe(sound, "en")

    def does(self, several: Sequence[Transcript], wanted: Call) -> Outcome:
        """What becomes of these utterances, where that was meant, by the worst of what is done."""
        outcomes = {self._does(said, wanted) for said in several}
        return next(one for one in Outcome if one in {*outcomes, Outcome.NOTHING})

    def _does(self, said: Transcript, wanted: Call) -> Outcome:
        meaning, _ = self.answer(said)
        if meaning is None:
            return Outcome.NOTHING
        right = whole(self.skills, meaning.calls) == whole(self.skills, (wanted,))
        if self._drives(meaning):
            if not meaning.sure:
                return Outcome.ASKED if right else Outcome.NOTHING
            return Outcome.RIGHT if right else Outcome.WRONG
        return Outcome.RIGHT if right else Outcome.NOTHING

    def moves(self, said: Transcript) -> bool:
        """Whether it would move for these words, unasked."""
        return self.effect(said) == "moves"

    def effect(self, said: Transcript) -> str:
        """What becomes of these words, whatever they mean."""
        return self.effect_of(self.answer(said)[0])

    def effect_of(self, meaning: Meaning | None) -> str:
        """What becomes of this meaning of some words."""
        if meaning is None:
            return Outcome.NOTHING.value
        if self._drives(meaning):
            return "moves" if meaning.sure else "asks"
        lasting = any(self.skills[call.skill].lasting for call in meaning.every_call)
        return "changes something for good" if lasting else Outcome.NOTHING.value

    @cached_property
    def interpreter(self) -> Interpreter:
        """What understands its words."""
        agent = Agent("robot", "", self.skills)
        return Interpreter(
            [agent], self._bus, self._clock, decider=open_decider(), phonemes=open_phonemes()
        )

    def answer(self, said: Transcript) -> tuple[Meaning | None, str]:
        """What these words mean, and what is said about them before anything is done."""
        turn = Turn(
            1, self._bus, self._clock, lambda: None, way=Way.VOICE,
            hearing=said.confidence, others=said.others, rate=said.rate,
        )  # fmt: skip
        meaning = self.interpreter.understand(said.text, turn)
        if meaning is None:
            return None, turn.text
        return self.interpreter.as_heard(meaning, said.text, turn), turn.text

    def _drives(self, meaning: Meaning) -> bool:
        return any(self.skills[call.skill].drives for call in meaning.every_call)


def utterances(sound: Samples) -> Iterator[Samples]:
    """What the listener would give to be understood."""
    vad, endpointer = open_vad(), Endpointer()
    for frame in frames(sound):
        signal = endpointer.push(frame, vad.probability(frame.samples))
        if isinstance(signal, SpeechEnded):
            yield signal.samples
    if last := endpointer.finish():
        yield last.samples
