"""A conversation with speech output that plays as far as the test lets it."""

import threading
from collections.abc import Sequence

import pytest
from guards import HUNG_S
from support.clock import HeldClock
from support.conversation import Eloquent, Talk

from edgevox.agent.llm.prompt import CUT_MARK
from edgevox.agent.llm.protocol import SAY
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.cancel import Cancelled
from edgevox.core.commands import Heard, Interrupt, Speak, SpokenOver, TextInput, Transcribing
from edgevox.core.events import (
    Responded,
    State,
    StateChanged,
    Transcribed,
    TurnMeasured,
)
from edgevox.core.speech import Spoken


class Saying:
    """One utterance; it lasts until the test says that all is played, or it is cut."""

    def __init__(self, token, on_audible, played, clock):
        self.token, self.sentences, self._on_audible = token, [], on_audible
        self._played, self._clock = played, clock

    def say(self, sentence):
        self.sentences.append(sentence)
        if len(self.sentences) == 1:
            self._on_audible()

    def finish(self):
        forget = self.token.on_cancel(self._played.set)
        assert self._played.wait(HUNG_S)
        forget()
        if self.token.cancelled:
            return Spoken("Once upon", cut=True, first_audible_s=self._clock.now())
        return Spoken(
            " ".join(self.sentences), first_audible_s=self._clock.now() + 0.25, synthesis_s=0.125
        )


class PacedSpeech:
    def __init__(self, clock):
        self.utterances, self.played, self._clock = [], threading.Event(), clock
        self.held = 0

    def hold(self):
        self.held += 1

    def release(self):
        self.held -= 1

    def begin(self, token, on_audible):
        self.utterances.append(Saying(token, on_audible, self.played, self._clock))
        return self.utterances[-1]


class Story(Eloquent):
    """A model that tells a story of two sentences."""

    def __init__(self):
        super().__init__(SAY, "Once upon a time. ", "There was a robot.")
        self.seen = []

    def generate(self, messages, *, grammar, max_tokens, token):
        self.seen.append(messages)
        yield from self._pieces


class Rig(Talk):
    def __init__(self):
        self.driving, self.goal_token, clock = threading.Event(), None, HeldClock(100.0)
        self.model, self.speech_output = Story(), PacedSpeech(clock)

        @skill(templates=["drive on"], says="Driving on.")
        def drive_on(goal):
            """Drive until told otherwise."""
            self.goal_token = goal.token
            self.driving.set()
            goal.token.wait(HUNG_S)
            raise Cancelled(goal.token.reason)

        super().__init__(
            skills=SkillSet([drive_on]),
            model=self.model,
            speech_output=self.speech_output,
            clock=clock,
        )

    def speaks(self):
        self.until(lambda: State.SPEAKING in self.states)

    @property
    def states(self):
        return [event.state for event in self.of(StateChanged)]

    def __exit__(self, *_):
        self.speech_output.played.set()
        super().__exit__()


def test_it_is_speaking_until_all_was_played():
    with Rig() as rig:
        rig.conversation.submit(Speak("Hello there."))
        rig.speaks()
        assert not rig.of(Responded)
        rig.speech_output.played.set()
        rig.settle()
        assert rig.of(Responded) == [Responded("Hello there.", 1)]
        assert rig.states == [State.LISTENING, State.SPEAKING, State.LISTENING]


def test_heard_words_go_from_transcribing_to_thinking_to_speaking():
    with Rig() as rig:
        rig.speech_output.played.set()
        rig.conversation.submit(Transcribing())
        rig.conversation.submit(Heard("tell me a story", ended_s=99.0, stt_s=0.4))
        rig.settle()
        assert rig.states == [
            State.LISTENING,
            State.TRANSCRIBING,
            State.THINKING,
            State.SPEAKING,
            State.LISTENING,
        ]
        assert [event.text for event in rig.of(Transcribed)] == ["tell me a story"]


def test_a_turn_is_measured_from_the_end_of_the_speech_to_the_first_audible_sample():
    with Rig() as rig:
        rig.speech_output.played.set()
        rig.conversation.submit(Heard("tell me a story", ended_s=99.0, stt_s=0.4))
        rig.settle()
        (measured,) = rig.of(TurnMeasured)
        assert (measured.stt, measured.tts) == (0.4, 0.125)
        assert measured.ttfs == 1.25
        assert measured.total == 1.0


def test_silence_that_was_taken_for_speech_is_not_answered():
    with Rig() as rig:
        rig.conversation.submit(Transcribing())
        rig.conversation.submit(Heard("", ended_s=99.0))
        rig.settle()
        assert rig.states == [State.LISTENING, State.TRANSCRIBING, State.LISTENING]
        assert not rig.of(Transcribed)
        assert not rig.speech_output.utterances


def test_history_holds_what_was_heard_with_a_mark_that_it_was_cut():
    with Rig() as rig:
        rig.conversation.submit(TextInput("tell me a story"))
        rig.speaks()
        rig.conversation.submit(Interrupt("spoken over", motion=False))
        rig.settle()
        assert rig.of(Responded) == [Responded("Once upon", 1, cut=True)]
        assert State.INTERRUPTED in rig.states
        rig.speech_output.played.set()
        rig.conversation.submit(TextInput("and then?"))
        rig.settle()
        told = [m.content for m in rig.model.seen[-1] if m.role == "assistant"]
        assert told[-1].endswith(f"Once upon{CUT_MARK}")


def test_speaking_over_the_robot_cuts_its_words_but_not_its_drive():
    with Rig() as rig:
        rig.conversation.submit(TextInput("drive on"))
        assert rig.driving.wait(HUNG_S)
        rig.speaks()
        rig.conversation.submit(Interrupt("spoken over", motion=False))
        assert rig.speech_output.utterances[0].token.cancelled
        assert not rig.goal_token.cancelled
        rig.conversation.submit(Heard("stop", ended_s=99.0))
        assert rig.goal_token.cancelled


@pytest.mark.parametrize("words", ["", "Mm-hmm.", "Yeah, okay.", "Oh, I see."])
def test_who_only_listens_does_not_end_its_answer(words):
    with Rig() as rig:
        rig.conversation.submit(TextInput("tell me a story"))
        rig.speaks()
        rig.conversation.submit(SpokenOver())
        assert rig.speech_output.held == 1
        rig.conversation.submit(Transcribing())
        rig.conversation.submit(Heard(words, ended_s=101.0, over=True))

        assert rig.speech_output.held == 0
        assert not rig.speech_output.utterances[0].token.cancelled
        rig.speech_output.played.set()
        rig.settle()
        assert len(rig.speech_output.utterances) == 1
        assert not rig.of(Responded)[0].cut
        assert [one.text for one in rig.of(Transcribed)][1:] == [words] * bool(words)


@pytest.mark.parametrize("words", ["No.", "Where are you?", "yeah, drive on"])
def test_other_words_end_its_answer(words):
    with Rig() as rig:
        rig.conversation.submit(TextInput("tell me a story"))
        rig.speaks()
        rig.conversation.submit(SpokenOver())
        rig.conversation.submit(Heard(words, ended_s=101.0, over=True))

        assert rig.speech_output.utterances[0].token.cancelled
        rig.speech_output.played.set()
        rig.settle()
        assert rig.of(Responded)[0].cut
        assert [one.text for one in rig.of(Transcribed)][1] == words


@pytest.mark.parametrize(
    ("words", "confidence", "goes_on"),
    [("Shore.", 0.7, True), ("Shore.", 0.9, False), ("No list.", 0.7, False),
     ("Where are you?", 0.6, False), ("That is not what I meant.", 0.7, False)],
)  # fmt: skip
def test_a_few_words_that_mean_nothing_and_were_hardly_heard_do_not_end_its_answer(
    words: str, confidence: float, goes_on: bool
) -> None:
    with Rig() as rig:
        rig.conversation.submit(TextInput("tell me a story"))
        rig.speaks()
        rig.conversation.submit(SpokenOver())
        rig.conversation.submit(Heard(words, ended_s=101.0, confidence=confidence, over=True))

        assert rig.speech_output.utterances[0].token.cancelled is not goes_on
        rig.speech_output.played.set()
        rig.settle()


@pytest.mark.parametrize(
    ("confidence", "likeliest", "goes_on"),
    [(0.7, "Okay.", True), (0.7, "Stop.", False), (0.9, "Okay.", False)],
)  # fmt: skip
def test_a_stop_that_was_hardly_heard_and_sounds_far_more_like_okay_lets_a_robot_that_stands_go_on(
    confidence: float, likeliest: str, goes_on: bool
) -> None:
    with Rig() as rig:
        rig.conversation.submit(TextInput("tell me a story"))
        rig.speaks()
        rig.conversation.submit(SpokenOver())
        rig.conversation.submit(_heard_as_halt(confidence, likeliest))

        assert rig.speech_output.utterances[0].token.cancelled is not goes_on
        rig.speech_output.played.set()
        rig.settle()


def test_the_same_stops_a_robot_that_drives():
    with Rig() as rig:
        rig.conversation.submit(TextInput("drive on"))
        assert rig.driving.wait(HUNG_S)
        rig.speaks()
        rig.conversation.submit(SpokenOver())
        rig.conversation.submit(_heard_as_halt(0.7, "Okay."))

        assert rig.goal_token.cancelled


def _heard_as_halt(confidence: float, likeliest: str) -> Heard:
    def rate(texts: Sequence[str]) -> Sequence[float]:
        return [-6.0 if one == likeliest else -9.0 for one in texts]

    return Heard("Halt!", ended_s=101.0, confidence=confidence, rate=rate, over=True)


def test_a_stop_word_over_its_answer_stops_the_robot():
    with Rig() as rig:
        rig.conversation.submit(TextInput("drive on"))
        assert rig.driving.wait(HUNG_S)
        rig.speaks()
        rig.conversation.submit(SpokenOver())
        rig.conversation.submit(Heard("okay, stop", ended_s=101.0, over=True))

        assert rig.goal_token.cancelled


def test_an_interrupt_cuts_words_and_drive():
    with Rig() as rig:
        rig.conversation.submit(TextInput("drive on"))
        assert rig.driving.wait(HUNG_S)
        rig.speaks()
        rig.conversation.submit(Interrupt())
        assert rig.speech_output.utterances[0].token.cancelled
        assert rig.goal_token.cancelled
