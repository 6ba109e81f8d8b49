"""Turns of a whole agent that is spoken to, in real time, beside what its parts need alone.

The parts are measured in the same run, one after another, on the very sound, chat and sentences of
each turn: that is the floor of a pipeline in which nothing overlaps.
"""

import itertools
import math
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import numpy as np
from listener_rig import loud, says_espeak
from sentence_stream import SentenceBoundaryDetector
from voice_rig import says

from benchmarks.hearing.listening import quiet_room
from edgevox.agent.llm.language_model import ChatMessage, LanguageModel
from edgevox.agent.llm.protocol import SAY
from edgevox.apps.agent import build
from edgevox.apps.agent.queries import present_voices
from edgevox.apps.agent.voice import warm_up_hearing
from edgevox.apps.robots import build_body
from edgevox.core.agent_events import ToolCalled
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import SystemClock
from edgevox.core.commands import Heard, Interrupt, Reset, Speak, Transcribing
from edgevox.core.events import SentenceReady, State, StateChanged, Transcribed, TurnMeasured
from edgevox.core.settings import Settings
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, Samples
from edgevox.voice.sentence_synthesiser import normalise_for_speech, split_phrases
from edgevox.voice.sinks.paced import BLOCK_S, LEAD_S
from edgevox.voice.spoken_answer import loud_at
from edgevox.voice.tts.voices import VoicePool

PATIENCE_S = 120.0
GAP_S = 0.3
"""After a longer gap something else is said: the answer to who spoke over it."""
TALK = "Answer in four short, plain sentences."
PEOPLE = ("af_nova", "am_eric", "bf_lily", "bm_george")
"""Voices of Kokoro's that nothing was tuned with take turns in asking; Piper answers."""
FOUR_SENTENCES = 'root ::= s s s s\ns ::= [A-Z] [A-Za-z, ]{20,90} ". "'
CLOCK = SystemClock()


class Talkative:
    """A real model that answers in four sentences; the agent's own grammar allows two."""

    def __init__(self, model: LanguageModel) -> None:
        self._model = model
        self.name, self.context_tokens = model.name, model.context_tokens
        self.count_tokens, self.close = model.count_tokens, model.close
        self.done = threading.Event()

    def prime(self, _: Sequence[ChatMessage], token: CancelToken) -> None:
        self._model.prime([ChatMessage("system", TALK)], token)

    def generate(self, messages: Sequence[ChatMessage], **more: Any) -> Iterator[str]:
        yield SAY
        yield from self.answer(messages[-1].content, more["token"])
        self.done.set()

    def answer(self, question: str, token: CancelToken) -> Iterator[str]:
        """To nobody but who asks."""
        chat = [ChatMessage("system", TALK), ChatMessage("user", question)]
        yield from self._model.generate(chat, grammar=FOUR_SENTENCES, max_tokens=160, token=token)


@dataclass(frozen=True, slots=True)
class Turn:
    """One turn, in seconds.

    `wait_s` is the silence that ended the utterance, part of `ttfs_s`; `action_s` goes from the
    last voiced sample to the call of a skill; the floors are of the parts
    alone: until the first sound, and until all sound is made.
    """

    said: str
    heard: str
    sentences: int
    ttfs_s: float
    wait_s: float
    action_s: float
    stt_s: float
    model_s: float
    first_chunk_s: float
    synthesis_s: float

    @property
    def first_floor_s(self) -> float:
        return self.stt_s + self.model_s + self.first_chunk_s

    @property
    def whole_floor_s(self) -> float:
        return self.stt_s + self.model_s + self.synthesis_s


class Talk:
    """An agent in an apartment whose microphone and loudspeaker are here."""

    def __init__(self, talkative: bool = False) -> None:
        self._stack = ExitStack()
        settings = Settings(ros2=True, audio_in="ros2", audio_out="ros2", llm="none")
        self.model: Talkative | None = None
        opened = build.open_model
        if talkative:
            settings = Settings(ros2=True, audio_in="ros2", audio_out="ros2")

            def wrapped(*given: Any) -> Talkative:
                self.model = Talkative(opened(*given))
                return self.model

            build.open_model = wrapped
        self.body = body = build_body("robot-apartment", settings)
        self.parts = build.build_parts(self._stack, settings, body)
        build.open_model = opened
        self.voice = self.parts.voice
        self._listen()
        for part in (body, self.voice.speech_output, self.parts.conversation, self.parts.listener):
            build.start(self._stack, part)
        warm_up_hearing(self.voice, "en")
        self.voice.speech_output.warm_up()
        if self.model:
            self.model.prime([], CancelToken())
        self._pool, self._people = VoicePool(), itertools.cycle(PEOPLE)
        controls = self.parts.controls
        on_board = present_voices(lambda: (controls.language, controls.voice))
        self._voice = VoicePool().get(on_board()[0])

    def _listen(self) -> None:
        self.measured, self.speaking = threading.Event(), threading.Event()
        self.turn: TurnMeasured | None = None
        self.heard, self.sentences, self.played = [], [], []
        self.asked: list[Samples] = []
        self.ended_s = self.over_s = 0.0
        self.acted_s = math.nan
        bus, transcribe, submit = (
            self.parts.bus,
            self.voice.stt.transcribe,
            self.parts.conversation.submit,
        )
        bus.subscribe(TurnMeasured, self._note)
        bus.subscribe(Transcribed, lambda event: self.heard.append(event.text))
        bus.subscribe(ToolCalled, lambda _: self._act())
        bus.subscribe(SentenceReady, lambda event: self.sentences.append(event.text))
        bus.subscribe(
            StateChanged, lambda e: self.speaking.set() if e.state is State.SPEAKING else None
        )
        self.voice.relay.connect(lambda _: self.played.append(CLOCK.now()))
        self.transcribe = transcribe

        def noted(samples: Samples, language: str) -> str:
            self.asked.append(samples)
            return transcribe(samples, language)

        def taken(command: Any, *given: Any) -> None:
            if isinstance(command, Transcribing):
                self.over_s = CLOCK.now()
            if isinstance(command, Heard):
                self.ended_s = command.ended_s
            submit(command, *given)

        self.voice.stt.transcribe = noted
        self.parts.conversation.submit = taken

    def close(self) -> None:
        self._stack.close()

    def rest(self) -> None:
        """Have it forget what was said and stand."""
        self.parts.conversation.submit(Reset())
        self.parts.conversation.wait_idle()

    def ask(self, said: str) -> Turn:
        """Say it, and wait for its answer."""
        self.rest()
        for kept in (self.heard, self.sentences, self.asked):
            kept.clear()
        self.measured.clear(), self.speaking.clear()
        self.acted_s = math.nan
        spoken = loud(says("en", next(self._people), said, self._pool), 0.08)
        self.play(np.concatenate([quiet_room(0.5), spoken]))
        if self.model:
            self.model.done.clear()
            self._quiet_until(self.speaking)
            self._quiet_until(self.model.done)
            self.parts.conversation.submit(Interrupt("heard enough"))
        self._quiet_until(self.measured)
        return self._beside(said)

    def speak_over(self) -> float:
        """Seconds from a person's first voiced sample to the last sample that is played."""
        self.rest()
        self.speaking.clear(), self.played.clear()
        self.parts.conversation.submit(Speak("I have a long story to tell about this house. " * 4))
        self._quiet_until(self.speaking)
        self.play(quiet_room(1.0))
        person = loud(says_espeak("no wait a moment please", "en-us"), 0.3)
        voiced_s = CLOCK.now() + loud_at(person)[0] / 16_000
        self.play(np.concatenate([person, quiet_room(1.0)]))
        after = [at_s for at_s in self.played if at_s > voiced_s]
        gaps = (one for one, two in itertools.pairwise(after) if two - one > GAP_S)
        return float(next(gaps, after[-1]) + LEAD_S + BLOCK_S - voiced_s)

    def _act(self) -> None:
        if math.isnan(self.acted_s):
            self.acted_s = CLOCK.now()

    def _note(self, event: TurnMeasured) -> None:
        self.turn = event
        self.measured.set()

    def play(self, sound: Samples) -> None:
        """Into the microphone, as a room would."""
        start_s = CLOCK.now()
        for number in range(sound.size // FRAME_SAMPLES):
            left_s = start_s + (number + 1) * FRAME_S - CLOCK.now()
            if left_s > 0:
                threading.Event().wait(left_s)
            at = number * FRAME_SAMPLES
            self.voice.microphone.push(sound[at : at + FRAME_SAMPLES])

    def _quiet_until(self, event: threading.Event) -> None:
        until_s = CLOCK.now() + PATIENCE_S
        while not event.is_set():
            self.play(quiet_room(FRAME_S))
            assert CLOCK.now() < until_s, "it does not answer"

    def _beside(self, said: str) -> Turn:
        """The turn, and its parts alone."""
        stt_s = _timed(lambda: self.transcribe(self.asked[-1], "en"))
        sentences, model_s = list(self.sentences), 0.0
        if self.model:
            pieces: list[str] = []
            question = self.heard[0]
            model_s = _timed(lambda: pieces.extend(self.model.answer(question, CancelToken())))
            detector = SentenceBoundaryDetector()
            sentences = [*detector.add_chunk("".join(pieces)), detector.finish()]
            sentences = [sentence for sentence in sentences if sentence.strip()]
        first_s, whole_s = self._synthesis(sentences)
        return Turn(
            said,
            self.heard[0],
            len(sentences),
            self.turn.ttfs,
            self.over_s - self.ended_s,
            self.acted_s - self.ended_s,
            stt_s,
            model_s,
            first_s,
            whole_s,
        )

    def _synthesis(self, sentences: Sequence[str]) -> tuple[float, float]:
        """Seconds until the first audible sample is there, and until all sound is."""
        first_s, begun_s = 0.0, CLOCK.now()
        for sentence in sentences:
            for phrase in split_phrases(normalise_for_speech(sentence), self._voice.phrase_chars):
                for chunk in self._voice.synthesise(phrase, CancelToken()):
                    if not first_s:
                        silent_s = float(loud_at(chunk.samples)[0]) / chunk.rate_hz
                        first_s = CLOCK.now() - begun_s + silent_s
        return first_s, CLOCK.now() - begun_s


def _timed(work: Any) -> float:
    begun_s = CLOCK.now()
    work()
    return CLOCK.now() - begun_s
