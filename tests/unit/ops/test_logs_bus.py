"""What the bus tells the log, with a whole conversation that runs."""

import threading
from typing import Annotated, Literal

import pytest
from logs_rig import logging_to_memory

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import OneOf, SkillFailed, SkillSet, skill
from edgevox.apps.agent.build import free_text
from edgevox.core.agent_events import ToolCalled
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.events import (
    Cause,
    ControlChanged,
    Outcome,
    TurnEnded,
    TurnMeasured,
    WakeWordHeard,
)
from edgevox.core.log import get_logger
from edgevox.ops.logs import BusLog
from edgevox.ops.logs.observer import MOST_OPEN

SECRET = "xyzzy plugh"  # noqa: S105 - said aloud
of_skill = get_logger("edgevox.of_skill")
started = threading.Event()


def skills():
    @skill(templates=["go to [the] {room}"], says="Going to the {room}.", done="I am there.")
    def navigate_to(goal, room: Annotated[str, OneOf(("kitchen",))]):
        """Drive to a room."""
        of_skill.info("on_the_way")

    @skill(templates=["look for {thing}"], says="Looking for {thing}.", done="Here is {thing}.")
    def look_for(goal, thing: str, how: Literal["fast", "slow"] = "slow"):
        """Look for a thing."""
        raise SkillFailed(f"there is no {thing} here")

    @skill(templates=["wait for me"], says="I wait.")
    def wait(goal):
        """Wait until somebody stops it."""
        started.set()
        ended = threading.Event()
        goal.token.on_cancel(ended.set)
        ended.wait(60)
        raise Cancelled(goal.token.reason)

    return SkillSet([navigate_to, look_for, wait])


@pytest.fixture
def ask():
    """A conversation that is logged; asks and waits until all is done."""
    bus = Bus()
    agents = [Agent("robot", "", skills())]
    observed = BusLog(bus, free_text(agents))
    talk = Conversation(agents, bus, halt=lambda _: False)
    talk.start()

    def submit(*commands, wait=True):
        for command in commands:
            talk.submit(TextInput(command) if isinstance(command, str) else command)
        assert not wait or talk.wait_idle(10)

    submit.bus, submit.talk = bus, talk
    yield submit
    talk.close()
    observed.close()


def test_a_turn_is_told_from_its_beginning_to_its_goals_end(ask):
    with logging_to_memory() as logged:
        ask("go to the kitchen")
    events = [line["event"] for line in logged.lines]
    for one in ("turn_began", "skill_called", "goal_started", "turn_ended", "goal_succeeded"):
        assert one in events
    (call,) = logged.of("skill_called")
    assert call["path"] == "template"
    assert (call["skill"], call["arguments"]) == ("navigate_to", {"room": "kitchen"})
    (end,) = logged.of("turn_ended")
    assert (end["outcome"], end["path"], end["turn"]) == ("acted", "template", 1)
    assert end["total_s"] >= end["ttfs_s"] >= 0
    assert logged.of("goal_succeeded")[0]["ran_s"] >= 0


def test_the_lines_of_a_skill_have_its_turn_and_goal(ask):
    with logging_to_memory() as logged:
        ask("go to the kitchen")
    (line,) = logged.of("on_the_way")
    assert line["turn"] == 1
    assert line["goal"] == logged.of("goal_started")[0]["goal"]


def test_why_a_goal_failed_is_told_without_what_was_said(ask):
    with logging_to_memory() as logged:
        ask(f"look for {SECRET}")
    (failed,) = logged.of("goal_failed")
    assert failed["level"] == "warning"
    assert failed["reason"] == "there is no <11 characters> here"
    call = logged.of("goal_started")[0]
    assert call["arguments"] == {"thing": "<11 characters>", "how": "slow"}


def test_a_stop_word_is_told_with_what_it_stopped(ask):
    started.clear()
    with logging_to_memory() as logged:
        ask("wait for me", wait=False)
        assert started.wait(60)
        ask("stop")
    (stop,) = logged.of("safety_stop")
    assert (stop["level"], stop["word"], stop["stopped"]) == ("info", "stop", True)
    (goal,) = logged.of("goal_cancelled")
    assert goal["reason"] == "heard 'stop'"


def test_interrupts_changes_and_the_wake_word_are_told(ask):
    with logging_to_memory() as logged:
        ask(Interrupt(cause=Cause.TOPIC))
        ask.bus.publish(ControlChanged("language", "de"))
        ask.bus.publish(WakeWordHeard("hey jarvis"))
    assert logged.of("interrupted")[0]["cause"] == "topic"
    (changed,) = logged.of("control_changed")
    assert (changed["control"], changed["value"]) == ("language", "de")
    assert logged.of("wake_word")[0]["phrase"] == "hey jarvis"


def test_nothing_that_anybody_said_is_in_a_whole_run_at_info(ask):
    with logging_to_memory() as logged:
        for said in ("look for {}", "my name is {}", "go to the {}", "stop {}"):
            ask(said.format(SECRET))
    assert SECRET not in logged.text
    assert "plugh" not in logged.text
    assert len(logged.of("turn_ended")) >= 3


def test_everything_that_was_said_is_there_where_it_is_asked_for(ask):
    with logging_to_memory(log_speech=True) as logged:
        ask(f"look for {SECRET}")
    assert logged.of("turn_began")[0]["text"] == f"look for {SECRET}"
    assert SECRET in logged.of("goal_started")[0]["arguments"]["thing"]


def test_turns_that_never_end_are_forgotten_some_day():
    bus = Bus()
    observed = BusLog(bus, free_text([]))
    first, last = 1, MOST_OPEN + 1
    with logging_to_memory() as logged:
        for turn in range(first, last + 1):
            bus.publish(ToolCalled("wave", {}, "template", turn))
        for turn in (first, last):
            bus.publish(TurnMeasured(0.0, 0.0, 0.0, 0.0, 0.0, turn))
            bus.publish(TurnEnded(turn, Outcome.ACTED))
    observed.close()
    assert [told["path"] for told in logged.of("turn_ended")] == ["none", "template"]


@pytest.mark.parametrize(
    ("annotation", "free"),
    [
        (str, True),
        (str | None, True),
        (list[str], True),
        (int, False),
        (float | None, False),
        (bool, False),
        (Literal["a", "b"], False),
        (Literal["a", "b"] | None, False),
        (Annotated[str, OneOf(("kitchen",))], False),
    ],
)
def test_only_arguments_that_take_any_words_count_as_speech(annotation, free):
    def call(goal, one):
        """Do it."""

    call.__annotations__["one"] = annotation
    assert ("one" in skill()(call).free_text) is free
