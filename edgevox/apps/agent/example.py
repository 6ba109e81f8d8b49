"""An example of a command that the robot obeys, in its language, for those who meet it first."""

from collections.abc import Sequence
from typing import Any

from edgevox.agent.conversation import Conversation
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.skills import Skill


def example_command(conversation: Conversation, skills: Sequence[Skill]) -> str:
    """A plain command for the first skill that moves the robot; empty if there is none.

    It is one that the templates understand: an example must not fail. Any thread may ask.
    """
    interpreter = conversation.interpreter
    for one in skills:
        told = interpreter.phrases.action(one, _arguments(one)) if one.drives else ""
        meaning = interpreter.plain(told) if told else None
        if isinstance(meaning, Meaning) and [call.skill for call in meaning.calls] == [one.name]:
            return told
    return ""


def _arguments(one: Skill) -> dict[str, Any]:
    """The first word of each choice, the defaults of the rest, and 1 for what has none."""
    found: dict[str, Any] = {}
    for name, field in one.arguments_model.model_fields.items():
        words = one.choices[name].words if name in one.choices else ()
        found[name] = words[0] if words else 1.0 if field.is_required() else field.default
    return found
