"""Programs in words, in the language that is spoken: what each skill says when it begins."""

from edgevox.agent.phrase_forms import continued
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.programs.program import (
    After,
    Arrived,
    BatteryBelow,
    Do,
    Program,
    Repeat,
    Return,
    Say,
    Steps,
    When,
)
from edgevox.agent.skills import Call, SkillSet
from edgevox.core.errors import EdgeVoxError

_UNITS = (("hours", "hour", 3600), ("minutes", "minute", 60), ("seconds", "second", 1))
_MOST_UNITS = 2


def in_words(program: Program, phrases: Phrasebook, skills: SkillSet) -> str:
    """What it will do, as one sentence or several."""
    match program:
        case Do(calls=calls):
            return phrases.chained([_call(call, phrases, skills) for call in calls])
        case Steps(steps=steps):
            return phrases.chained([in_words(one, phrases, skills) for one in steps])
        case Say(words=words):
            return phrases.say("program_saying", words=words)
        case Return():
            return phrases.say("program_back")
        case Repeat(program=inner, count=None):
            return phrases.say("program_endless", order=_part(inner, phrases, skills))
        case Repeat(program=inner, count=count):
            order = _part(inner, phrases, skills)
            return phrases.say("program_times", count=f"{count:g}", order=order)
        case After(delay_s=delay_s, program=inner):
            duration = duration_in_words(delay_s, phrases)
            order = _part(inner, phrases, skills)
            return phrases.say("program_after", duration=duration, order=order)
        case When(condition=BatteryBelow(percent=percent), program=inner):
            order = _part(inner, phrases, skills)
            return phrases.say("program_low", percent=f"{percent:g}", order=order)
        case When(condition=Arrived(), program=inner):
            return phrases.say("program_arrived", order=_part(inner, phrases, skills))
    raise TypeError(program)


def duration_in_words(seconds: float, phrases: Phrasebook) -> str:
    """A duration in its two largest units: "an hour and 30 minutes"."""
    left = max(1, round(seconds))
    told: list[str] = []
    for several, one, size in _UNITS:
        number, left = divmod(left, size)
        if number:
            told.append(phrases.say(one if number == 1 else several, count=number))
    return phrases.both(told[:_MOST_UNITS])


def _part(program: Program, phrases: Phrasebook, skills: SkillSet) -> str:
    return continued(in_words(program, phrases, skills))


def _call(call: Call, phrases: Phrasebook, skills: SkillSet) -> str:
    one = skills[call.skill]
    try:
        said = phrases.acknowledge(one, one.validate(call.arguments))
    except EdgeVoxError:  # its place may have been forgotten since: that is told when it is due
        said = ""
    return said or phrases.say("program_action", action=phrases.can(one))
