"""What a stop forgets, and what it must not: words on their way, and settings."""

import threading

import phrases
import pytest
from support.clock import HeldClock

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, Interrupt, Reset, StopSpotted, TextInput, Transcribing
from edgevox.core.events import Responded, State, StateChanged, Transcribed


class Rig:
    def __init__(self):
        self.bus, self.events, self.busy, self.go_on = Bus(), [], threading.Event(), None

        @skill(templates=["say hello"], says="Hello.")
        def say_hello(goal):
            """Say hello."""

        @skill(templates=["think"], moves=False)
        def think(goal):
            """Think for a while."""
            self.busy.set()
            assert self.go_on.wait(60)

        @skill(templates=["wander"], says="I wander.")
        def wander(goal):
            """Move until somebody stops it, and break when that happens."""
            goal.token.on_cancel(lambda: 1 / 0)
            self.busy.set()
            goal.token.wait(60)
            goal.token.check()

        self.halted = []
        for kind in (Responded, StateChanged, Transcribed):
            self.bus.subscribe(kind, self.events.append)
        self.conversation = Conversation(
            [Agent("robot", "Be brief.", SkillSet([say_hello, think, wander]))],
            self.bus,
            halt=lambda reason: bool(self.halted.append(reason)),
            clock=HeldClock(100.0),
        )

    def of(self, kind):
        return [event for event in self.events if isinstance(event, kind)]

    def __enter__(self):
        self.go_on = threading.Event()
        self.conversation.start()
        return self

    def __exit__(self, *_):
        self.go_on.set()
        self.conversation.close()


@pytest.mark.parametrize("how", [TextInput("stop"), StopSpotted(99.0, "stop")])
def test_the_body_is_halted_though_what_a_skill_does_when_it_is_stopped_breaks(how, caplog):
    with Rig() as rig:
        rig.conversation.submit(TextInput("wander"))
        assert rig.busy.wait(60)

        rig.conversation.submit(how)

        assert len(rig.halted) == 1
        assert "cancel_callback_failed" in caplog.text
        assert rig.conversation.wait_idle(60)


def test_the_body_is_halted_though_ending_the_turn_breaks():
    class Broken:
        class token:  # noqa: N801
            @staticmethod
            def cancel(reason):
                raise ZeroDivisionError

    halted = []
    executor = SkillExecutor(Bus(), lambda reason: bool(halted.append(reason)), print)

    with pytest.raises(ZeroDivisionError):
        executor.stop("stop", Broken)

    assert halted == ["stop"]


def test_what_was_said_before_an_interrupt_and_is_understood_after_it_is_not_done():
    with Rig() as rig:
        rig.conversation.submit(Transcribing())
        rig.conversation.submit(Interrupt())
        rig.conversation.submit(Heard("say hello", ended_s=99.5))
        assert rig.conversation.wait_idle(10)

        assert rig.of(Transcribed) == []
        states = [event.state for event in rig.of(StateChanged)]
        assert State.INTERRUPTED in states
        assert states[-1] is State.LISTENING


def test_what_is_said_after_an_interrupt_is_done():
    with Rig() as rig:
        rig.conversation.submit(Interrupt())
        rig.conversation.submit(Heard("say hello", ended_s=100.5))
        assert rig.conversation.wait_idle(10)

        assert [event.text for event in rig.of(Transcribed)] == ["say hello"]


def test_a_stop_that_was_said_before_an_interrupt_still_stops():
    with Rig() as rig:
        rig.conversation.submit(Interrupt())
        rig.conversation.submit(Heard("stop", ended_s=99.0))
        assert rig.conversation.wait_idle(10)

        assert [event.text for event in rig.of(Responded)] == [phrases.said("standing")]


def test_what_was_said_after_a_spoken_stop_is_done_though_that_was_understood_late():
    with Rig() as rig:
        rig.conversation.submit(Heard("stop", ended_s=98.0))
        rig.conversation.submit(Heard("say hello", ended_s=99.0))
        assert rig.conversation.wait_idle(10)

        assert [event.text for event in rig.of(Transcribed)] == ["stop", "say hello"]


def test_a_language_that_was_set_is_not_forgotten_by_a_stop():
    with Rig() as rig:
        rig.conversation.submit(TextInput("think"))
        assert rig.busy.wait(60)
        rig.conversation.set_language("fr")
        rig.conversation.submit(Reset())
        rig.go_on.set()
        assert rig.conversation.wait_idle(10)
        rig.conversation.submit(TextInput("blorp"))
        assert rig.conversation.wait_idle(10)

        assert rig.of(Responded)[-1].text.startswith("Je n'ai pas compris")
