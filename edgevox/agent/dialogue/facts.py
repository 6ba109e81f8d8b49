"""What the conversation can tell of the robot: what it did, where it was, the time, its name.

A fact is a skill that moves nothing: see `edgevox/robots/facts.py` for those of bodies. The last of
these here are for what nobody told the robot: it says so, and a language model invents nothing.
"""

from collections.abc import Callable, Mapping
from typing import Annotated

from edgevox.agent.dialogue.memory import Dialogue, MotionRecord
from edgevox.agent.known import Known, about_s
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import GoalHandle, Result, Skill, skill
from edgevox.agent.skills.skill import NewName
from edgevox.core.agent_events import GoalStatus

LAST_DONE = "what_did_you_do"
WHERE_BEFORE = "where_were_you"
WAY_LEFT = "how_much_further"
OF_DIALOGUE = (
    LAST_DONE, WHERE_BEFORE, WAY_LEFT, "what_time", "what_date", "who_are_you", "do_you_hear_me",
    "where_is_it", "how_far_is_it",
)  # fmt: skip
"""Names of the facts that every robot has."""


def dialogue_facts(
    dialogue: Dialogue,
    skills: Mapping[str, Skill],
    phrases: Callable[[], Phrasebook],
    known: Known,
) -> tuple[Skill, ...]:
    """The facts of `OF_DIALOGUE`. `skills` are all skills of the robot."""
    return (*_past(dialogue, skills, phrases, known), *_today(known), *_self(), *_unknown())


def _past(
    dialogue: Dialogue,
    skills: Mapping[str, Skill],
    phrases: Callable[[], Phrasebook],
    known: Known,
) -> tuple[Skill, ...]:
    @skill(moves=False)
    def what_did_you_do(goal: GoalHandle) -> Result:
        """Say what the robot did last, and how that ended."""
        goal.token.check()
        moved = dialogue.moved()
        if moved is None:
            return {}
        action = _in_words(moved, skills, phrases())
        ended = moved.status
        return {
            "done": action,
            "now": ended is GoalStatus.RUNNING,
            "worked": ended is GoalStatus.SUCCEEDED,
            "stopped": ended is GoalStatus.CANCELLED,
        }

    @skill(moves=False)
    def where_were_you(goal: GoalHandle) -> Result:
        """Say where the robot was before its last motion."""
        goal.token.check()
        start = dialogue.came_from()
        if start is None:
            return {}
        place = known.place_at(start.x_m, start.y_m)
        return {"room": place, "x": round(start.x_m, 2), "y": round(start.y_m, 2)}

    @skill(moves=False)
    def how_much_further(goal: GoalHandle) -> Result:
        """Say how much of the running motion is left."""
        goal.token.check()
        running = dialogue.running()
        if running is None:
            return {}
        way = known.way_left()
        left_s = way.seconds if way else dialogue.left_s(running)
        left = {"left_s": about_s(left_s)} if left_s is not None else {}
        return {"running": True, "metres": way.metres if way else None, **left}

    return what_did_you_do, where_were_you, how_much_further


def _in_words(moved: MotionRecord, skills: Mapping[str, Skill], book: Phrasebook) -> str:
    one = skills[moved.skill]
    return book.acknowledge(one, moved.arguments) or book.say("busy", action=book.can(one))


def _today(known: Known) -> tuple[Skill, ...]:
    @skill(moves=False)
    def what_time(goal: GoalHandle) -> Result:
        """Say what time it is."""
        goal.token.check()
        return {"time": f"{known.today():%H:%M}"}

    @skill(moves=False)
    def what_date(goal: GoalHandle) -> Result:
        """Say which day it is."""
        goal.token.check()
        now = known.today()
        return {"weekday": now.weekday(), "day": now.day, "month": now.month, "year": now.year}

    return what_time, what_date


def _self() -> tuple[Skill, ...]:
    @skill(moves=False)
    def who_are_you(goal: GoalHandle) -> Result:
        """Say what the robot is called."""
        goal.token.check()
        return {}

    @skill(moves=False)
    def do_you_hear_me(goal: GoalHandle) -> Result:
        """Say that the robot hears."""
        goal.token.check()
        return {}

    return who_are_you, do_you_hear_me


def _unknown() -> tuple[Skill, ...]:
    @skill(moves=False)
    def where_is_it(goal: GoalHandle, what: Annotated[str, NewName()]) -> Result:
        """Say that the robot does not know where something is."""
        goal.token.check()
        return {"what": what}

    @skill(moves=False)
    def how_far_is_it(goal: GoalHandle, what: Annotated[str, NewName()]) -> Result:
        """Say that the robot does not know how far something is."""
        goal.token.check()
        return {"what": what}

    return where_is_it, how_far_is_it
