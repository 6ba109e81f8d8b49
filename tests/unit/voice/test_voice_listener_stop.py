"""The stop word spotter in the listener, scripted: the word is a frame whose samples are 9000."""

import numpy as np
import pytest
from voice_script import VOICE, Refuses, Script, Stt, Vad, Wake, spoken

from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, StopSpotted, Transcribing
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES
from edgevox.voice.listener import Listener
from edgevox.voice.stop_spotter.detector import WORD_S, StopWatch, may_stop
from edgevox.voice.word_detection import OncePerWord

STOP = 9000
QUIET_WORD = 3000
MUTTERED = [*[QUIET_WORD - 1] * 6, QUIET_WORD]
"""A spotter hears a word at its end."""


class Spotter:
    """Hears a stop word in a frame of one level."""

    word = "halt"

    def __init__(self, level=STOP):
        self.level, self.forgotten = level, 0
        self._once = OncePerWord(10 * FRAME_S)

    def heard(self, samples, probability, language="en", *, playing=False):
        return self._once.counts(bool(samples[0] == self.level))

    def forget(self):
        self.forgotten += 1


class Told(Spotter):
    """Keeps how likely a voice was in each frame, and whether the robot may be heard in it."""

    def __init__(self):
        super().__init__()
        self.told = []

    def heard(self, samples, probability, language="en", *, playing=False):
        self.told.append((probability, playing))
        return super().heard(samples, probability)


class Broken(Spotter):
    def heard(self, samples, probability, language="en", *, playing=False):
        raise RuntimeError("bug")


def hear(stt, *steps, detector=None, audible=0.0, speaks="en", said=None, **more):
    said = [] if said is None else said
    listener = Listener(
        Script(*steps),
        Vad(),
        stt,
        submit=said.append,
        bus=Bus(),
        language=lambda: speaks,
        muted=more.pop("muted", lambda: False),
        audible=lambda: audible,
        is_stop=lambda text: "stop" in text,
        stop_detector=detector or Spotter(),
        lossless=True,
        **more,
    )
    listener.start()
    assert listener.wait_over(60)
    listener.close()
    return said


def spots(said):
    return [one for one in said if isinstance(one, StopSpotted)]


def test_a_stop_word_is_told_with_its_frame_and_its_utterance_says_that_it_was():
    said = hear(Stt("stop!"), *[VOICE] * 10, STOP, *spoken())

    assert [type(one) for one in said] == [StopSpotted, Transcribing, Heard]
    assert said[0] == StopSpotted(11 * FRAME_S, "halt", goes_on=True)
    assert said[2].spotted


def test_a_stop_that_whoever_takes_it_broke_on_is_told_again_with_its_words():
    said = hear(Stt("stop!"), *[VOICE] * 10, STOP, *spoken(), said=Refuses(StopSpotted))

    assert [type(one) for one in said] == [Transcribing, Heard]
    assert (said[1].text, said[1].spotted) == ("stop!", True)


def test_the_next_utterance_does_not_say_so():
    said = hear(Stt("stop!", "thanks"), *[VOICE] * 10, STOP, *spoken(), *spoken())

    assert [one.spotted for one in said if isinstance(one, Heard)] == [True, False]


def test_a_stop_word_in_what_is_no_utterance_is_told_to_be_over():
    said = hear(Stt(), *[0] * 10, STOP, *[0] * 10)

    assert said == [StopSpotted(11 * FRAME_S, "halt")]


def test_it_needs_no_wake_word_and_is_answered_though_nobody_looks_at_the_words():
    long_talk = [VOICE] * 100

    said = hear(Stt(), *long_talk, STOP, *spoken(), wakeword=Wake())

    assert [type(one) for one in said] == [StopSpotted, Transcribing, Heard]
    assert (said[2].text, said[2].spotted) == ("", True)


def test_without_the_wake_word_nothing_else_of_it_is_understood():
    said = hear(Stt("go to the kitchen"), *[VOICE] * 10, STOP, *spoken(), wakeword=Wake())

    assert [(one.text, one.spotted) for one in said if isinstance(one, Heard)] == [("", True)]


def test_while_muted_it_hears_nothing():
    said = hear(Stt(), *[VOICE] * 10, STOP, *spoken(), muted=lambda: True)

    assert said == []


def test_what_is_muted_in_the_middle_is_answered_all_the_same():
    muted = []

    said = hear(Stt(), *[VOICE] * 10, STOP, lambda: muted.append(1), *spoken(), muted=lambda: muted)

    assert [type(one) for one in said] == [StopSpotted, Transcribing, Heard]
    assert said[2].spotted


def test_an_utterance_that_is_refused_is_answered_all_the_same(monkeypatch):
    monkeypatch.setattr("edgevox.voice.transcriber.MAX_WAITING", 0)

    said = []
    listener = Listener(
        Script(*[VOICE] * 10, STOP, *spoken()),
        Vad(),
        Stt(),
        submit=said.append,
        bus=Bus(),
        language=lambda: "en",
        muted=lambda: False,
        audible=lambda: 0.0,
        stop_detector=Spotter(),
    )
    listener.start()
    assert listener.wait_over(60)
    listener.close()

    assert said[-1].spotted


def test_a_spotter_that_fails_leaves_the_robot_its_hearing(caplog):
    broken = Broken()

    said = hear(Stt("go"), *spoken(), detector=broken)

    assert [one.text for one in said if isinstance(one, Heard)] == ["go"]
    assert broken.forgotten > 1  # what it made of frames before does not count any more
    assert "stop_spotter_failed" in caplog.text


@pytest.mark.parametrize("speaks", ["de", "ja"])
def test_it_listens_whatever_language_is_spoken(speaks):
    said = hear(Stt("stop"), *[VOICE] * 10, STOP, *spoken(), speaks=speaks)

    assert len(spots(said)) == 1


def test_it_is_told_of_any_voice():
    spotter = Told()

    hear(Stt("go"), *[0] * 10, *spoken(), detector=spotter)

    assert set(spotter.told) == {(0.0, False), (1.0, False)}


def test_it_is_told_in_every_frame_that_the_robot_speaks():
    spotter = Told()

    hear(Stt("go"), *[0] * 10, *spoken(), detector=spotter, audible=0.5)

    assert {playing for _, playing in spotter.told} == {True}


def test_it_forgets_what_was_heard_when_something_is_missing():
    spotter = Spotter()

    hear(Stt("go"), *spoken(), detector=spotter)

    assert spotter.forgotten > 0


def test_the_robots_own_stopped_does_not_stop_it():
    quiet = Spotter(QUIET_WORD)

    said = hear(Stt(), *MUTTERED, detector=quiet, audible=0.3, saying=lambda: "Stopped.")

    assert spots(said) == []


@pytest.mark.parametrize("text", ["I am in the kitchen.", ""])
def test_while_it_says_something_else_or_nobody_knows_what_it_stops(text):
    said = hear(Stt(), *MUTTERED, detector=Spotter(QUIET_WORD), audible=0.3, saying=lambda: text)

    assert len(spots(said)) == 1


def test_who_is_louder_than_its_stopped_stops_it():
    said = hear(Stt("stop"), *[VOICE] * 8, STOP, *spoken(), audible=0.05, saying=lambda: "Stopped.")

    assert len(spots(said)) == 1


def test_where_the_echo_is_cancelled_elsewhere_every_stop_word_counts():
    said = hear(
        Stt(),
        *MUTTERED,
        detector=Spotter(QUIET_WORD),
        audible=0.3,
        saying=lambda: "Stopped.",
        echo="none",
    )

    assert len(spots(said)) == 1


@pytest.mark.parametrize(
    ("language", "text", "may"),
    [
        ("en", "Stopped.", True),
        ("en", "I can drive, turn and stop.", True),
        ("de", "Ich halte an.", True),
        ("de", "Ich kann nicht stop sagen.", True),
        ("fr", "Je suis à l'arrêt.", False),
        ("en", "I am in the kitchen.", False),
        ("ja", "止まれと聞こえました。", True),
    ],
)
def test_what_it_says_may_sound_like_a_stop_word(language, text, may):
    assert may_stop(text, language) is may


@pytest.mark.parametrize(("probability", "stops"), [(0.0, False), (0.9, True)])
def test_what_is_heard_before_the_robot_speaks_is_somebody_only_with_a_voice_in_it(
    probability, stops
):
    """All passes the gate while nothing plays: silence before "Stopped." is no person."""
    watch = StopWatch(Spotter(), saying=lambda: "Stopped.", language=lambda: "en")
    silence, word = (np.full(FRAME_SAMPLES, level, np.int16) for level in (0, STOP))

    for _ in range(round(WORD_S / FRAME_S)):
        assert not watch.heard(silence, probability, playing=False, loud=True)

    assert watch.heard(word, 0.9, playing=True, loud=False) is stops
