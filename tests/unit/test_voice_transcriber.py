"""The transcriber alone: what it tells of an utterance, whatever breaks in it."""

import numpy as np
import pytest
from voice_script import Stt
from waiting import Heard as Told

from edgevox.core.clock import SystemClock
from edgevox.core.commands import Heard, Transcribing
from edgevox.voice.transcriber import Transcriber, TranscriptionJob

SOUND = np.zeros(1600, np.int16)


def breaks(*_):
    raise ZeroDivisionError("a bug")


@pytest.fixture
def transcribe():
    made = []

    def run(*jobs, language=lambda: "en", is_stop=lambda _: False):
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
        for job in jobs:
            assert one.take(job)
        assert one.wait_idle(60)
        assert one.alive
        return told.messages, one.failed

    yield run
    for one in made:
        one.close()


def test_a_bug_amid_an_utterance_ends_it_with_no_words(transcribe):
    said, failed = transcribe(
        TranscriptionJob(SOUND, 1.0), TranscriptionJob(SOUND, 2.0), language=breaks
    )

    assert said == [Transcribing(), Heard("", 1.0), Transcribing(), Heard("", 2.0)]
    assert failed == 2


@pytest.mark.parametrize("spotted", [True, False])
def test_a_bug_where_only_a_stop_would_count_tells_one_that_was_spotted(transcribe, spotted):
    said, failed = transcribe(
        TranscriptionJob(SOUND, 1.0, only_stop=True, spotted=spotted), is_stop=breaks
    )

    assert said == ([Heard("", 1.0, spotted=True)] if spotted else [])
    assert failed == 1
