"""What the agent does: an event becomes JSON with its kind and what applies to it."""

import json
from typing import get_args

import pytest

from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import (
    AgentEvent,
    AgentEventKind,
    AskedCall,
    Confirmation,
    ConfirmationStatus,
    DrainChanged,
    DrainStatus,
    GoalCancelled,
    GoalChanged,
    GoalRejected,
    GoalStatus,
    HandedOver,
    ProgramChanged,
    ProgramStatus,
    SafetyPreempted,
    SoftwareStopChanged,
    ToolCalled,
    UtteranceLeft,
    as_json,
)
from edgevox.core.bus import Bus
from edgevox.core.reason import Reason

AT_SEA = Reason("I am at sea.", "stuck", {"x": Reason("sea")})
EVENTS = (
    (
        ToolCalled("drive", {"far": 2}, "template", 3),
        (
            '{"kind": "tool_call", "skill": "drive", "arguments": {"far": 2}, '
            '"source": "template", "turn": 3}'
        ),
    ),
    (
        GoalChanged("a", "drive", {}, GoalStatus.RUNNING, 3, feedback={"progress": 0.5}),
        (
            '{"kind": "skill_goal", "goal_id": "a", "skill": "drive", "arguments": {}, '
            '"status": "running", "turn": 3, "feedback": {"progress": 0.5}}'
        ),
    ),
    (
        GoalChanged("a", "drive", {}, GoalStatus.SUCCEEDED, 3, result={}),
        (
            '{"kind": "skill_goal", "goal_id": "a", "skill": "drive", "arguments": {}, '
            '"status": "succeeded", "turn": 3, "result": {}}'
        ),
    ),
    (
        GoalChanged(
            "a",
            "drive",
            {},
            GoalStatus.FAILED,
            0,
            reason=Reason("I am at sea.", "stuck", {"x": Reason("sea")}),
        ),
        (
            '{"kind": "skill_goal", "goal_id": "a", "skill": "drive", "arguments": {}, '
            '"status": "failed", "turn": 0, "error": "I am at sea.", "code": "stuck", '
            '"values": {"x": "sea"}}'
        ),
    ),
    (
        GoalCancelled("a", "drive", {}, 3, because("preempted", skill="turn")),
        (
            '{"kind": "skill_cancelled", "goal_id": "a", "skill": "drive", "arguments": {}, '
            '"status": "cancelled", "turn": 3, "reason": "pre-empted by turn", '
            '"code": "preempted", "values": {"skill": "turn"}}'
        ),
    ),
    (
        GoalRejected("fly", "{", Reason("no such skill")),
        (
            '{"kind": "skill_goal", "goal_id": null, "skill": "fly", "arguments_json": "{", '
            '"status": "rejected", "error": "no such skill", "turn": 0}'
        ),
    ),
    (
        HandedOver("host", "driver", 1),
        '{"kind": "handoff", "from": "host", "to": "driver", "turn": 1}',
    ),
    (
        ProgramChanged("p", "In 5 minutes: going.", ProgramStatus.WAITING, 4, due_in_s=300.0),
        (
            '{"kind": "program", "program_id": "p", "text": "In 5 minutes: going.", '
            '"status": "waiting", "turn": 4, "due_in_s": 300.0}'
        ),
    ),
    (
        SafetyPreempted("halt", stopped=False),
        '{"kind": "safety_preempt", "word": "halt", "stopped": false, "heard_by": "words"}',
    ),
    (
        SoftwareStopChanged(engaged=True, by="a phone"),
        '{"kind": "software_stop", "engaged": true, "by": "a phone"}',
    ),
    (
        DrainChanged(DrainStatus.DRAINING, "SIGTERM", 20.0),
        '{"kind": "drain", "status": "draining", "by": "SIGTERM", "within_s": 20.0}',
    ),
    (UtteranceLeft("Rosie"), '{"kind": "utterance_left", "robot": "Rosie"}'),
    (
        Confirmation(
            ConfirmationStatus.ASKED, "Shall I?", (AskedCall("drive", {"far": 2}),), 20.0, 3
        ),
        (
            '{"kind": "confirmation", "status": "asked", "question": "Shall I?", '
            '"calls": [{"skill": "drive", "arguments": {"far": 2}}], "expires_s": 20.0, "turn": 3, '
            '"goes": false}'
        ),
    ),
)


@pytest.mark.parametrize(("event", "text"), EVENTS, ids=lambda one: type(one).__name__)
def test_an_event_is_json_by_the_names_of_the_wire(event, text) -> None:
    assert json.dumps(as_json(event)) == text
    assert repr(as_json(event)) == repr(json.loads(text)), "plain values, as scenarios print them"


def test_every_kind_is_told_by_some_event_and_all_are_looked_at_here() -> None:
    assert {one.kind for one in get_args(AgentEvent)} == set(AgentEventKind)
    assert {type(event) for event, _ in EVENTS} == set(get_args(AgentEvent))


def test_who_subscribes_to_all_of_them_hears_each_once_until_they_leave() -> None:
    bus, heard = Bus(), []
    leave = bus.subscribe(AgentEvent, heard.append)
    bus.subscribe(SafetyPreempted, heard.append)
    for event, _ in EVENTS:
        bus.publish(event)
    assert [one for one in heard if not isinstance(one, SafetyPreempted)] == [
        one for one, _ in EVENTS if not isinstance(one, SafetyPreempted)
    ]
    assert sum(isinstance(one, SafetyPreempted) for one in heard) == 2
    leave()
    bus.publish(HandedOver("driver", "host", 2))
    assert len(heard) == len(EVENTS) + 1
