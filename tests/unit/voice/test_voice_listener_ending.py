"""The end of an utterance by its words, in the endpointer and the listener, scripted."""

import threading

import pytest
from voice_script import VOICE, WAKE, Script, Stt, Vad, Wake, spoken
from waiting import wait_until

from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, SpokenOn
from edgevox.core.speech import Ending
from edgevox.voice.audio import FRAME_S
from edgevox.voice.listener import Listener
from edgevox.voice.utterance_end import EARLY_S, END_S, ENDS_AFTER_S, GOES_ON_S

SAID = [VOICE] * 20
SAID_S = 20 * FRAME_S
PAUSE = [0] * round(EARLY_S / FRAME_S)
"""After so much silence, and no more, the words are guessed."""
LATER = [0] * 60


class Rig:
    """A listener that judges by a table of texts, and steps that wait for its judgement."""

    def __init__(self, *texts, endings=None, **more):
        self.said, self.stt = [], Stt(*texts)
        endings = endings or {}
        self.script = Script()
        self.listener = Listener(
            self.script,
            Vad(),
            self.stt,
            submit=self.said.append,
            bus=Bus(),
            language=lambda: "en",
            muted=lambda: False,
            audible=lambda: 0.0,
            is_stop=lambda text: "stop" in text,
            ending=lambda text: Ending(endings.get(text, Ending.OPEN)),
            **more,
        )

    def judged(self, said_s=SAID_S):
        """A step that waits until the words are known that were said until then."""
        return lambda: wait_until(lambda: self.listener.transcriber.ending_at(said_s) is not None)

    def logged(self, log):
        """A step that waits until it is logged that they could not be judged."""
        return lambda: wait_until(lambda: "ending_unjudged" in log.text)

    def told(self, kind=Heard):
        """A step that waits until so much was told."""
        return lambda: wait_until(lambda: self.of(kind))

    def of(self, kind):
        return [one for one in self.said if isinstance(one, kind)]

    def hear(self, *steps):
        self.script.steps = list(steps)
        self.listener.start()
        assert self.listener.wait_over(60)
        self.listener.close()
        return [one.text for one in self.of(Heard)]


def silence(seconds):
    """So many seconds of it, less what was heard already."""
    return [0] * (round(seconds / FRAME_S) - len(PAUSE))


def test_a_whole_command_ends_at_once():
    rig = Rig("go to the kitchen", endings={"go to the kitchen": Ending.WHOLE})

    texts = rig.hear(*SAID, *PAUSE, rig.judged(), 0, rig.told(), *LATER)

    assert texts == ["go to the kitchen"]
    assert len(rig.stt.heard) == 1


@pytest.mark.parametrize("ending", [Ending.MAY_GO_ON, Ending.OPEN, Ending.BROKEN_OFF])
def test_other_words_wait_for_as_long_as_they_want(ending):
    rig = Rig("turn left", "turn left now", endings={"turn left": ending})
    almost = silence(ENDS_AFTER_S[ending] - FRAME_S)

    assert rig.hear(*SAID, *PAUSE, rig.judged(), *almost, *SAID, *LATER) == ["turn left now"]
    assert rig.of(SpokenOn) == []


@pytest.mark.parametrize("ending", [Ending.MAY_GO_ON, Ending.OPEN, Ending.BROKEN_OFF])
def test_and_for_no_longer(ending):
    rig = Rig("turn left", endings={"turn left": ending})
    enough = silence(ENDS_AFTER_S[ending])

    assert rig.hear(*SAID, *PAUSE, rig.judged(), *enough, rig.told()) == ["turn left"]


def test_what_breaks_off_waits_longer_than_anything():
    assert ENDS_AFTER_S[Ending.BROKEN_OFF] > GOES_ON_S > END_S


@pytest.mark.parametrize("pause_s", [0.3, 0.5, 0.8])
def test_who_speaks_on_after_a_whole_command_takes_it_back_and_is_heard_whole(pause_s):
    whole = "go to the kitchen, and then to the bedroom"
    rig = Rig("go to the kitchen", whole, endings={"go to the kitchen": Ending.WHOLE})
    rest = silence(pause_s)

    texts = rig.hear(*SAID, *PAUSE, rig.judged(), *rest, rig.told(), *SAID, *LATER)

    assert texts == ["go to the kitchen", whole]
    (taken_back,) = rig.of(SpokenOn)
    assert taken_back.ended_s == rig.of(Heard)[0].ended_s
    assert rig.stt.heard[1].size > 2 * len(SAID) * 512


def test_who_speaks_later_says_something_else():
    rig = Rig("go to the kitchen", "thanks", endings={"go to the kitchen": Ending.WHOLE})

    texts = rig.hear(*SAID, *PAUSE, rig.judged(), *LATER, *spoken(after=60))

    assert texts == ["go to the kitchen", "thanks"]
    assert rig.of(SpokenOn) == []


def test_a_stop_ends_at_once_and_is_never_taken_back():
    rig = Rig("stop", "and go to the kitchen", endings={"stop": Ending.FINAL})

    texts = rig.hear(*SAID, *PAUSE, rig.judged(), *[0] * 8, *SAID, *LATER)

    assert texts == ["stop", "and go to the kitchen"]
    assert rig.of(SpokenOn) == []


def test_a_pause_of_eight_tenths_of_a_second_cuts_no_open_sentence():
    rig = Rig("tell me", "tell me about the moon")
    assert rig.hear(*SAID, *PAUSE, rig.judged(), *silence(0.8), *SAID, *LATER) == [
        "tell me about the moon"
    ]


def test_a_pause_cuts_no_sentence_before_a_slow_machine_knows_its_words(monkeypatch):
    rig, asked, known = (
        Rig("a latte with", "a latte with milk"),
        threading.Event(),
        threading.Event(),
    )
    hear = rig.stt.transcribe

    def held(*given):
        asked.set()
        assert known.wait(60)
        return hear(*given)

    monkeypatch.setattr(rig.stt, "transcribe", held)

    texts = rig.hear(*SAID, *PAUSE, asked.wait, *silence(1.3), *SAID, known.set, *LATER)

    assert texts == ["a latte with milk"]


def test_words_that_cannot_be_judged_are_open(caplog):
    rig = Rig("hello", endings={"hello": None})

    assert rig.hear(*SAID, *PAUSE, rig.logged(caplog), *LATER) == ["hello"]


def test_a_file_is_heard_with_its_silences_whatever_is_said():
    rig = Rig("go to the", "kitchen", endings={"go to the": Ending.BROKEN_OFF}, lossless=True)

    texts = rig.hear(*SAID, *PAUSE, rig.judged(), *silence(END_S), *SAID, *LATER)

    assert texts == ["go to the", "kitchen"]


def test_without_the_wake_word_a_fixed_silence_ends_an_utterance():
    rig = Rig("stop now", endings={"stop": Ending.FINAL}, wakeword=Wake())

    assert rig.hear(*SAID, *PAUSE, *silence(END_S - FRAME_S), *SAID, *LATER) == ["stop now"]
    assert len(rig.stt.heard) == 1


WOKEN = [VOICE] * 9 + [WAKE] + SAID
"""The wake word and a command in one breath."""
WOKEN_S = len(WOKEN) * FRAME_S


def test_a_whole_command_after_the_wake_word_ends_at_once():
    rig = Rig(
        "Hey Jarvis, go to the kitchen",
        endings={"go to the kitchen": Ending.WHOLE},
        wakeword=Wake(),
    )

    texts = rig.hear(*WOKEN, *PAUSE, rig.judged(WOKEN_S), 0, rig.told(), *LATER)

    assert texts == ["go to the kitchen"]
    assert len(rig.stt.heard) == 1


def test_who_speaks_on_after_it_is_heard_whole_and_then_needs_the_wake_word_again():
    whole = "go to the kitchen, and then to the bedroom"
    rig = Rig(
        "Hey Jarvis, go to the kitchen", f"Hey Jarvis, {whole}", "we had lunch",
        endings={"go to the kitchen": Ending.WHOLE}, wakeword=Wake(),
    )  # fmt: skip

    texts = rig.hear(
        *WOKEN, *PAUSE, rig.judged(WOKEN_S), *silence(0.5), rig.told(), *SAID, *LATER,
        *spoken(after=60),
    )  # fmt: skip

    assert texts == ["go to the kitchen", whole]
    assert len(rig.of(SpokenOn)) == 1


def test_what_breaks_off_after_the_wake_word_waits():
    rig = Rig(
        "Hey Jarvis, go to the", "Hey Jarvis, go to the kitchen",
        endings={"go to the": Ending.BROKEN_OFF}, wakeword=Wake(),
    )  # fmt: skip

    texts = rig.hear(*WOKEN, *PAUSE, rig.judged(WOKEN_S), *silence(1.4), *SAID, *LATER)

    assert texts == ["go to the kitchen"]
