"""What speech output promises, in simulated time and with voices that beep."""

import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from queue import SimpleQueue

import numpy as np
import pytest
from guards import HUNG_S
from speech_output_rig import (
    CHAR_S,
    Beeper,
    Recorder,
    Voices,
    choices,
    wait_for,
)
from support.clock import HeldClock

from edgevox.core.cancel import CancelToken
from edgevox.core.speech import Spoken
from edgevox.voice import speech_output
from edgevox.voice.audio import Chunk
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
from edgevox.voice.sinks.paced import PacedSink
from edgevox.voice.speech_output import SpeechOutput
from edgevox.voice.spoken_answer import BACK_S, SpeakingUtterance, play_chunk

ONE, TWO = "I drive to the kitchen.", "Then I come back."


@dataclass
class Rig:
    clock: HeldClock = field(default_factory=lambda: HeldClock(100.0))
    output: Recorder = field(default_factory=Recorder)
    voice: Beeper = field(default_factory=Beeper)
    spare: Beeper = field(default_factory=Beeper)
    names: list[str] = field(default_factory=lambda: ["best", "spare"])
    language: str = "en"

    def __post_init__(self) -> None:
        self.pool = Voices(best=self.voice, spare=self.spare)
        self.synthesiser = SentenceSynthesiser(
            lambda: choices(*self.names, language=self.language), self.pool, clock=self.clock
        )
        sink = PacedSink(self.output, clock=self.clock, wait=self.clock.wait)
        self.speech_output = SpeechOutput(self.synthesiser, sink, clock=self.clock)

    def speak(self, *sentences: str, token: CancelToken | None = None) -> Spoken:
        utterance = self.speech_output.begin(token or CancelToken(), lambda: None)
        for sentence in sentences:
            utterance.say(sentence)
        return utterance.finish()

    def speak_until(self, cut_s: float, *sentences: str) -> Spoken:
        """Cut it at that time of the clock, when all of it was synthesised.

        Before that, how long a word takes is an estimate, and so is which of them was heard.
        """
        token, made = CancelToken(), SimpleQueue[threading.Event]()

        def cut() -> None:
            wait_for(made.get(timeout=HUNG_S))
            token.cancel("enough")

        self.clock.at(cut_s, cut)
        utterance = self.speech_output.begin(token, lambda: None)
        for sentence in sentences:
            utterance.say(sentence)
        made.put(self.speech_output.prepare())
        return utterance.finish()


@pytest.fixture
def rig() -> Iterator[Rig]:
    rig = Rig()
    rig.speech_output.start()
    yield rig
    rig.speech_output.close()


def seconds(*texts: str) -> float:
    return sum((len(text) + 1) * CHAR_S for text in texts)


def test_all_sentences_are_played_one_after_the_other_without_a_gap(rig: Rig):
    began_s = rig.clock.now()
    spoken = rig.speak(ONE, TWO)
    assert spoken.text == f"{ONE} {TWO}"
    assert not spoken.cut
    assert rig.output.seconds == pytest.approx(seconds(ONE, TWO), abs=1e-3)
    assert rig.clock.now() - began_s == pytest.approx(seconds(ONE, TWO), abs=1e-2)


def test_the_first_sample_is_told_once_with_its_time_on_the_clock(rig: Rig):
    told = []
    utterance = rig.speech_output.begin(CancelToken(), lambda: told.append(rig.clock.now()))
    utterance.say(ONE)
    spoken = utterance.finish()
    assert spoken.first_audible_s == pytest.approx(rig.output.blocks[0][0])
    assert len(told) == 1
    assert told[0] - spoken.first_audible_s < 0.1


def test_the_second_sentence_is_synthesised_before_the_first_has_been_played(rig: Rig):
    second_begun = threading.Event()
    rig.voice.before_chunk = lambda word: second_begun.set() if word == "Then" else None
    rig.clock.at(rig.clock.now() + 0.5, lambda: wait_for(second_begun))
    assert rig.speak(ONE, TWO).text == f"{ONE} {TWO}"


def test_the_first_sentence_is_heard_before_the_second_is_said(rig: Rig):
    audible = threading.Event()
    utterance = rig.speech_output.begin(CancelToken(), audible.set)
    utterance.say(ONE)
    wait_for(audible)
    utterance.say(TWO)
    assert utterance.finish().text == f"{ONE} {TWO}"


def test_cutting_leaves_the_words_that_were_heard_and_falls_silent_at_once(rig: Rig):
    cut_s = rig.clock.now() + seconds("I drive to") + 0.05
    spoken = rig.speak_until(cut_s, ONE, TWO)
    assert spoken == Spoken(
        "I drive to",
        cut=True,
        first_audible_s=spoken.first_audible_s,
        synthesis_s=spoken.synthesis_s,
    )
    assert rig.output.end_s - cut_s <= 0.1


def test_cutting_while_a_voice_works_ends_it_after_that_chunk(rig: Rig):
    token, working = CancelToken(), threading.Event()
    go_on = threading.Event()

    def hold(word: str) -> None:
        if word == "drive":
            working.set()
            wait_for(go_on)

    rig.voice.before_chunk = hold
    utterance = rig.speech_output.begin(token, lambda: None)
    utterance.say(ONE)
    utterance.say(TWO)
    wait_for(working)
    token.cancel("enough")
    spoken = utterance.finish()
    go_on.set()
    assert spoken.cut
    assert spoken.text in {"", "I"}
    assert rig.speak("Yes.").text == "Yes."
    assert rig.voice.heard == [ONE, "Yes."]


def held_at(rig: Rig, seconds_in: float) -> threading.Event:
    """Hold what plays then; the event is set when it was."""
    held = threading.Event()
    hold = rig.speech_output.hold
    rig.clock.at(rig.clock.now() + seconds_in, lambda: (hold(), held.set()))
    return held


def test_a_held_answer_is_silent_at_once_and_goes_on_where_it_was(rig: Rig):
    began_s = rig.clock.now()
    held = held_at(rig, seconds("I drive to") + 0.05)
    utterance = rig.speech_output.begin(CancelToken(), lambda: None)
    utterance.say(ONE)
    utterance.say(TWO)
    wait_for(held)
    heard_s = rig.output.seconds
    assert rig.output.end_s - began_s <= seconds("I drive to") + 0.15

    rig.speech_output.release()

    spoken = utterance.finish()
    assert (spoken.text, spoken.cut) == (f"{ONE} {TWO}", False)
    again_s = rig.output.seconds - seconds(ONE, TWO)
    assert 0 <= again_s <= BACK_S + 0.1
    assert heard_s < seconds("I drive to") + 0.15


def test_a_held_answer_that_is_cut_says_no_more_and_the_next_one_is_not_held(rig: Rig):
    token, held = CancelToken(), held_at(rig, seconds("I drive to") + 0.05)
    utterance = rig.speech_output.begin(token, lambda: None)
    utterance.say(ONE)
    wait_for(held)
    wait_for(rig.speech_output.prepare())  # all was synthesised: how long a word takes is known

    token.cancel("spoken over")

    spoken = utterance.finish()
    assert (spoken.text, spoken.cut) == ("I drive to", True)
    assert rig.speak(TWO).text == TWO


def test_nothing_is_held_where_nothing_is_said(rig: Rig):
    rig.speech_output.hold()

    assert rig.speak(ONE).text == ONE


def test_an_answer_that_nobody_releases_goes_on_by_itself(rig: Rig, monkeypatch):
    monkeypatch.setattr(speech_output, "HELD_S", 0.05)
    held_at(rig, seconds("I drive to") + 0.05)

    assert rig.speak(ONE).text == ONE


def test_it_goes_on_from_a_pause_between_two_words():
    rate_hz = 16_000
    loud = np.full(rate_hz, 8000, np.int16)
    loud[7_200:8_000] = 0  # a pause at 0.45 s
    played, holds = [], iter([None] * 8 + [0.1])

    class Sink:
        def play(self, chunk, _token):
            played.append(chunk.samples)
            return 0.0

    utterance = SpeakingUtterance(CancelToken(), lambda: None, lambda *_: None, lambda _: None)
    line = utterance.log.begin(ONE)

    play_chunk(Chunk(loud, rate_hz), line, utterance, Sink(), lambda: next(holds, None))

    assert sum(map(len, played[:8])) == 12_800
    again = np.concatenate(played[8:])
    assert 8_000 <= loud.size - again.size + 800 <= 8_800
    assert not again[:160].any()


def test_an_utterance_that_is_cut_before_it_sounds_says_nothing(rig: Rig):
    token = CancelToken()
    token.cancel("too late")
    assert rig.speak(ONE, token=token) == Spoken("", cut=True)
    assert rig.output.blocks == []


def test_a_token_that_is_cancelled_after_the_last_sample_cuts_nothing(rig: Rig):
    token = CancelToken()
    spoken = rig.speak(ONE, token=token)
    token.cancel("late")
    assert not spoken.cut
    assert rig.speak(TWO).text == TWO


def test_another_voice_speaks_from_the_next_sentence_on(rig: Rig):
    utterance = rig.speech_output.begin(CancelToken(), lambda: None)
    utterance.say(ONE)
    first = rig.speech_output.prepare()
    wait_for(first)
    rig.names = ["spare"]
    utterance.say(TWO)
    assert utterance.finish().text == f"{ONE} {TWO}"
    assert (rig.voice.heard, rig.spare.heard) == ([ONE], [TWO])


def test_a_voice_that_fails_is_counted_and_the_next_one_says_the_sentence(rig: Rig):
    rig.voice.fails_on = "kitchen"
    assert rig.speak(ONE).text == ONE
    assert rig.spare.heard == [ONE]
    assert rig.synthesiser.failures == 1


def test_a_voice_that_does_not_load_is_replaced_too(rig: Rig):
    rig.names = ["unknown", "spare"]
    assert rig.speak(ONE).text == ONE
    assert rig.synthesiser.failures == 1
    assert rig.synthesiser.last is not None
    assert rig.synthesiser.last[0].name == "spare"


def test_a_sentence_that_no_voice_can_say_is_not_reported_as_spoken(rig: Rig):
    rig.voice.fails_on = rig.spare.fails_on = "Stop"
    assert rig.speak(ONE, "Stop now.", TWO).text == f"{ONE} {TWO}"
    assert rig.synthesiser.failures == 2


def test_what_is_spoken_is_cleaned_but_reported_as_it_was_written(rig: Rig):
    assert rig.speak("The *red* cup! 🎉").text == "The *red* cup! 🎉"
    assert rig.voice.heard == ["The red cup!"]


def test_a_script_without_spaces_is_cut_at_a_character(rig: Rig):
    rig.language = "ja"
    assert rig.speak_until(rig.clock.now() + 0.56, "とまりましたよ").text == "とまりま"


def test_closing_cuts_what_is_spoken_and_answers_who_waits():
    rig = Rig()
    rig.speech_output.start()
    audible, spoken = threading.Event(), []
    rig.clock.at(rig.clock.now() + 0.3, lambda: wait_for(closing))
    closing = threading.Event()
    utterance = rig.speech_output.begin(CancelToken(), audible.set)
    utterance.say(ONE)
    waiter = threading.Thread(target=lambda: spoken.append(utterance.finish()))
    waiter.start()
    wait_for(audible)
    utterance.token.on_cancel(closing.set)
    rig.speech_output.close()
    waiter.join(60)
    assert [one.cut for one in spoken] == [True]
    assert not [t for t in threading.enumerate() if t.name.startswith("edgevox-")]


def test_a_closed_speech_output_says_nothing_and_does_not_hang():
    rig = Rig()
    rig.speech_output.start()
    rig.speech_output.close()
    assert rig.speak(ONE) == Spoken("", cut=True)
    assert rig.speech_output.prepare().is_set()
