"""Reading a model's prompt ahead, on a thread that must be over before the model is closed."""

import signal
import threading

import pytest
from guards import HUNG_S

from edgevox.agent.llm.prefill import PromptPrefill


class Left(BaseException):
    """What a signal's handler raises in the main thread."""


class Reader:
    """A model that reads until it is told to stop, and then still has something to do."""

    def __init__(self):
        self.reads, self.told, self.go_on = (threading.Event() for _ in range(3))
        self.over = False

    def prime(self, messages, token):
        token.on_cancel(self.told.set)
        self.reads.set()
        assert self.told.wait(HUNG_S)
        assert self.go_on.wait(HUNG_S)
        self.over = True


@pytest.fixture
def interrupted():
    """Have a signal raise in the main thread, as SIGTERM does in the program."""

    def leave(number, frame):
        raise Left

    before = signal.signal(signal.SIGUSR1, leave)
    yield lambda: signal.pthread_kill(threading.main_thread().ident, signal.SIGUSR1)
    signal.signal(signal.SIGUSR1, before)


def test_who_is_called_away_while_it_reads_still_waits_for_the_reader_when_closing(interrupted):
    reader = Reader()
    prefill = PromptPrefill(reader, [])
    prefill.start()
    assert reader.reads.wait(HUNG_S)

    def wait():
        threading.Timer(0.1, interrupted).start()
        prefill.wait()

    with pytest.raises(Left):
        wait()

    threading.Timer(0.1, reader.go_on.set).start()
    prefill.close()

    assert reader.told.is_set()
    assert reader.over
