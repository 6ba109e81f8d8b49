"""What a stop forgets, and what it must not: words on their way, and settings."""

import threading

import phrases
import pytest
from guards import HUNG_S
from support.conversation import Talk

from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, Interrupt, Reset, StopSpotted, TextInput, Transcribing
from edgevox.core.events import State, StateChanged, Transcribed


class Rig(Talk):
    """Skills of its own; `at` is a time of its clock."""

    def __init__(self):
        self.busy, self.go_on = threading.Event(), threading.Event()

        @skill(templates=["say hello"], says="Hello.")
        def say_hello(goal):
            """Say hello."""

        @skill(templates=["think"], moves=False)
        def think(goal):
            """Think for a while."""
            self.busy.set()
            assert self.go_on.wait(HUNG_S)

        @skill(templates=["wander"], says="I wander.")
        def wander(goal):
            """Move until somebody stops it, and break when that happens."""
            goal.token.on_cancel(lambda: 1 / 0)
            self.busy.set()
            goal.token.wait(HUNG_S)
            goal.token.check()

        super().__init__(skills=SkillSet([say_hello, think, wander]))

    def submit(self, *commands):
        for one in commands:
            self.conversation.submit(one)

    def heard(self, text, ago_s):
        """Words that ended so long before now."""
        return Heard(text, ended_s=self.clock.now() - ago_s)

    @property
    def transcribed(self):
        return [event.text for event in self.of(Transcribed)]


@pytest.mark.parametrize("how", [TextInput("stop"), StopSpotted(999.0, "stop")])
def test_the_body_is_halted_though_what_a_skill_does_when_it_is_stopped_breaks(how, caplog):
    with Rig() as rig:
        halted = []
        rig.body.on_halt = lambda: halted.append(1)
        rig.submit(TextInput("wander"))
        assert rig.busy.wait(HUNG_S)

        rig.submit(how)

        assert len(halted) == 1
        assert "cancel_callback_failed" in caplog.text
        rig.settle()


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
        rig.submit(Transcribing(), Interrupt(), rig.heard("say hello", 0.5))
        rig.settle()

        assert rig.transcribed == []
        states = [event.state for event in rig.of(StateChanged)]
        assert State.INTERRUPTED in states
        assert states[-1] is State.LISTENING


def test_what_is_said_after_an_interrupt_is_done():
    with Rig() as rig:
        rig.submit(Interrupt(), rig.heard("say hello", -0.5))
        rig.settle()

        assert rig.transcribed == ["say hello"]


def test_a_stop_that_was_said_before_an_interrupt_still_stops():
    with Rig() as rig:
        rig.submit(Interrupt(), rig.heard("stop", 1.0))
        rig.settle()

        assert rig.said == [phrases.said("standing")]


def test_what_was_said_after_a_spoken_stop_is_done_though_that_was_understood_late():
    with Rig() as rig:
        rig.submit(rig.heard("stop", 2.0), rig.heard("say hello", 1.0))
        rig.settle()

        assert rig.transcribed == ["stop", "say hello"]


def test_a_language_that_was_set_is_not_forgotten_by_a_stop():
    with Rig() as rig:
        rig.submit(TextInput("think"))
        assert rig.busy.wait(HUNG_S)
        rig.conversation.set_language("fr")
        rig.submit(Reset())
        rig.go_on.set()
        rig.settle()

        assert rig.say("blorp").startswith("Je n'ai pas compris")
