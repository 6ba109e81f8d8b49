"""An event of each kind that has a topic, as large as they usually are."""

from types import UnionType

from edgevox.core import events
from edgevox.core.agent_events import AgentEvent, GoalChanged, GoalStatus
from edgevox.robots.apartment import ApartmentRobot

SENTENCE = "I am in the living room, at x 4.3, y 0.8."
GOAL = GoalChanged(
    "0" * 32,
    "navigate_to",
    {"room": "kitchen"},
    GoalStatus.RUNNING,
    turn=1,
    feedback={"progress": 0.5, "distance_m": 2.25, "x": 4.313, "y": 0.842},
)


def samples() -> dict[type | UnionType, object]:
    """By the type of the event."""
    return {
        events.Transcribed: events.Transcribed("go to the kitchen"),
        events.Responded: events.Responded(SENTENCE),
        events.StateChanged: events.StateChanged(events.State.LISTENING),
        events.AudioLevel: events.AudioLevel(0.25),
        events.TurnMeasured: events.TurnMeasured(0.4, 0.9, 0.1, 1.2, 2.5),
        events.RobotState: events.RobotState(ApartmentRobot().state()),
        AgentEvent: GOAL,
        events.TokenGenerated: events.TokenGenerated(" kitchen"),
        events.SentenceReady: events.SentenceReady(SENTENCE),
        events.WakeWordHeard: events.WakeWordHeard("hey jarvis"),
        events.Answered: events.Answered(
            "list_languages", {"current": "en", "languages": {"en": {"name": "English"}}}
        ),
    }
