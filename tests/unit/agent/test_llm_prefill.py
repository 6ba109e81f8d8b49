"""Reading a model's prompt ahead, on a thread that must be over before the model is closed."""

import threading

from guards import HUNG_S

from edgevox.agent.llm.prompt import PromptPrefill
from edgevox.core.cancel import CancelToken


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


def test_closing_tells_the_reader_to_stop_and_waits_for_it():
    reader = Reader()
    prefill = PromptPrefill(reader, [])
    prefill.start()
    assert reader.reads.wait(HUNG_S)

    threading.Timer(0.1, reader.go_on.set).start()
    prefill.close()

    assert reader.told.is_set()
    assert reader.over


def test_it_reads_only_after_what_is_more_urgent():
    reader, urgent, done = Reader(), threading.Event(), threading.Event()

    def after():
        urgent.set()
        assert done.wait(HUNG_S)

    prefill = PromptPrefill(reader, [], after=after)
    prefill.start()
    assert urgent.wait(HUNG_S)
    assert not reader.reads.is_set()

    done.set()
    assert reader.reads.wait(HUNG_S)
    reader.go_on.set()
    prefill.close()


def test_closed_before_its_turn_it_reads_nothing(monkeypatch):
    reader, urgent, done = Reader(), threading.Event(), threading.Event()

    class Telling(CancelToken):
        def cancel(self, reason="cancelled"):
            first = super().cancel(reason)
            done.set()
            return first

    monkeypatch.setattr("edgevox.agent.llm.prompt.CancelToken", Telling)

    def after():
        urgent.set()
        assert done.wait(HUNG_S)

    prefill = PromptPrefill(reader, [], after=after)
    prefill.start()
    assert urgent.wait(HUNG_S)

    prefill.close()

    assert not reader.reads.is_set()


def test_it_may_be_closed_though_it_was_never_started():
    PromptPrefill(Reader(), []).close()
