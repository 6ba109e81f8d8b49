from edgevox.core.bus import Bus
from edgevox.core.events import Responded, Transcribed


def test_a_subscriber_hears_its_own_kind_of_event_in_order():
    bus = Bus()
    heard = []
    bus.subscribe(Transcribed, heard.append)
    bus.publish(Transcribed("one"))
    bus.publish(Responded("not for you"))
    bus.publish(Transcribed("two"))
    assert heard == [Transcribed("one"), Transcribed("two")]


def test_a_subscriber_that_fails_does_not_silence_the_others(failed_subscribers):
    bus = Bus()
    heard = []

    def broken(event):
        raise RuntimeError("broken face")

    bus.subscribe(Transcribed, broken)
    bus.subscribe(Transcribed, heard.append)
    bus.publish(Transcribed("hello"))
    assert heard == [Transcribed("hello")]
    assert "broken face" in failed_subscribers.take()


def test_after_unsubscribing_nothing_is_heard():
    bus = Bus()
    heard = []
    bus.subscribe(Transcribed, heard.append)()
    bus.publish(Transcribed("hello"))
    assert heard == []
