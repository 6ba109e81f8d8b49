import threading

import pytest

from edgevox.core.cancel import Cancelled, CancelToken


def test_cancelling_runs_each_callback_once_with_the_reason_known():
    token = CancelToken()
    heard = []
    token.on_cancel(lambda: heard.append(token.reason))
    assert token.cancel("stop") is True
    assert token.cancel("again") is False
    assert heard == ["stop"]


def test_a_callback_registered_late_runs_at_once():
    token = CancelToken()
    token.cancel()
    heard = []
    token.on_cancel(lambda: heard.append(1))
    assert heard == [1]


def test_a_forgotten_callback_does_not_run():
    token = CancelToken()
    heard = []
    token.on_cancel(lambda: heard.append(1))()
    token.cancel()
    assert heard == []


def test_a_child_is_cancelled_with_its_parent_but_not_the_other_way_round():
    parent = CancelToken()
    first, second = parent.child(), parent.child()
    first.cancel()
    assert not parent.cancelled
    parent.cancel("all")
    assert second.cancelled
    assert second.reason == "all"


def test_a_detached_child_lives_on():
    parent = CancelToken()
    child = parent.child()
    child.detach()
    parent.cancel()
    assert not child.cancelled


def test_wait_returns_when_another_thread_cancels():
    token = CancelToken()
    thread = threading.Thread(target=token.cancel)
    thread.start()
    assert token.wait(60)
    thread.join()


def test_check_raises_only_after_cancelling():
    token = CancelToken()
    token.check()
    token.cancel("enough")
    with pytest.raises(Cancelled, match="enough"):
        token.check()


def test_a_callback_that_breaks_keeps_nobody_else_from_being_told(caplog):
    token, heard = CancelToken(), []
    token.on_cancel(lambda: 1 / 0)
    token.on_cancel(lambda: heard.append("told"))

    assert token.cancel("stop") is True

    assert heard == ["told"]
    assert "cancel_callback_failed" in caplog.text


def test_a_child_whose_callback_breaks_keeps_its_parent_from_nothing():
    parent, heard = CancelToken(), []
    parent.child().on_cancel(lambda: 1 / 0)
    parent.on_cancel(lambda: heard.append("told"))

    parent.cancel("stop")

    assert heard == ["told"]
