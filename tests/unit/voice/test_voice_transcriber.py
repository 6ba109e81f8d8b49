"""The transcriber alone: what it tells of an utterance, whatever breaks in it."""

from types import SimpleNamespace

import numpy as np
import pytest
from voice_script import Stt
from waiting import Heard as Told

from edgevox.core.clock import SystemClock
from edgevox.core.commands import Heard, Hypothesis, Transcribing
from edgevox.voice.stt.speech_to_text import MAY_STOP, MAY_STOP_SHOWN, Transcript
from edgevox.voice.transcriber import Transcriber, TranscriptionJob

SOUND = np.zeros(1600, np.int16)


def breaks(*_):
    raise ZeroDivisionError("a bug")


class Once:
    """Breaks the first time, and says then that it is so."""

    def __init__(self, answer):
        self.answer, self.broke = answer, False

    def __call__(self, *_):
        if not self.broke:
            self.broke = True
            breaks()
        return self.answer


@pytest.fixture
def transcribe(caplog):
    made = []

    def run(*jobs, guessed=None, language=lambda: "en", is_stop=lambda _: False):
        told = Told()
        one = Transcriber(
            Stt(*["stop"] * len(jobs)),
            told.add,
            language=language,
            is_stop=is_stop,
            clock=SystemClock(),
        )
        made.append(one)
        one.start()
        if guessed:
            assert one.guess(guessed)
            assert one.wait_idle(60)
        for job in jobs:
            assert one.take(job)
        assert one.wait_idle(60)
        assert one.alive
        assert "speech_to_text_broke" in caplog.text
        return told.messages, one.failed

    yield run
    for one in made:
        one.close()


def test_a_bug_amid_an_utterance_ends_it_with_no_words(transcribe):
    said, failed = transcribe(
        TranscriptionJob(SOUND, 0.0, 1.0), TranscriptionJob(SOUND, 0.0, 2.0), language=breaks
    )

    assert said == [Transcribing(), Heard("", 1.0), Transcribing(), Heard("", 2.0)]
    assert failed == 2


@pytest.mark.parametrize("spotted", [True, False])
def test_a_bug_where_only_a_stop_would_count_tells_one_that_was_spotted(transcribe, spotted):
    said, failed = transcribe(
        TranscriptionJob(SOUND, 0.0, 1.0, unaddressed=True, spotted=spotted), is_stop=breaks
    )

    assert said == ([Heard("", 1.0, spotted=True)] if spotted else [])
    assert failed == 1


def test_a_bug_while_it_may_not_be_over_yet_costs_nothing_of_it(transcribe):
    job = TranscriptionJob(SOUND, 0.0, 1.0)

    said, failed = transcribe(job, guessed=job, language=Once("en"))

    assert said == [Transcribing(), Heard("stop", 1.0, said[-1].stt_s, began_s=0.0)]
    assert failed == 1


def test_after_a_bug_a_stop_without_the_wake_word_is_heard(transcribe):
    said, failed = transcribe(
        TranscriptionJob(SOUND, 0.0, 1.0, unaddressed=True),
        TranscriptionJob(SOUND, 0.0, 2.0, unaddressed=True),
        is_stop=Once(answer=True),
    )

    assert said == [Heard("stop", 2.0, said[-1].stt_s, began_s=0.0)]
    assert failed == 1


def words_of(said):
    """What is told of an utterance that speech to text hears so."""
    told = Told()
    stt = SimpleNamespace(transcribe=lambda *_: said)
    one = Transcriber(
        stt, told.add, language=lambda: "en", is_stop=lambda text: text in ("stop", "halt"),
        clock=SystemClock(),
    )  # fmt: skip
    one.start()
    assert one.take(TranscriptionJob(SOUND, 0.0, 1.0))
    assert one.wait_idle(60)
    one.close()
    return [heard.text for heard in told.messages if isinstance(heard, Heard)]


@pytest.mark.parametrize(("share", "counts"), [(MAY_STOP, True), (MAY_STOP - 0.01, False)])
def test_a_stop_that_may_have_been_said_counts(share, counts):
    said = Transcript("the shop", 0.6, (Hypothesis("stop", share, 0.5),))

    assert words_of(said) == ["stop" if counts else "the shop"]


@pytest.mark.parametrize(("share", "counts"), [(MAY_STOP_SHOWN, True), (0.5, False)])
@pytest.mark.parametrize("text", ["the shop", ""])
def test_stop_words_that_were_shown_count_together(text, share, counts):
    several = (("stop", 0.4), ("halt", share - 0.4), ("go", 1.0 - share))
    said = Transcript(text, 0.6, stops=tuple(Hypothesis(one, part, 0.5) for one, part in several))

    assert words_of(said) == ["stop" if counts else text]
