"""What the full-screen terminal says about itself: the help, and what to try first."""

import textwrap
from collections.abc import Sequence
from typing import Any

from textual.binding import Binding, BindingType

from edgevox.agent.conversation import Conversation
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.skills import Skill
from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.terminal.slash_commands import command_rows
from edgevox.core.languages import LANGUAGES


def help_text(bindings: Sequence[BindingType], columns: int) -> str:
    """What can be typed, and all keys, in so many columns."""
    keys = [(key, about) for _, key, about in key_rows(bindings)]
    keys += [
        ("Up, Down", "Bring back an earlier line"),
        ("Tab", "Complete a command, a name or an earlier line"),
    ]
    return "\n".join(
        (
            "Type what the robot should do, or a command:",
            "",
            _table(command_rows(), columns),
            "",
            "Keys:",
            "",
            _table(keys, columns),
            "",
            "Escape closes this.",
        )
    )


def key_rows(bindings: Sequence[BindingType]) -> list[tuple[str, str, str]]:
    """The action of each key, the key as people write it, and what it does."""
    return [
        (one.action, _key_name(one.key), one.description)
        for one in bindings
        if isinstance(one, Binding)
    ]


def first_hint(parts: AgentParts) -> list[str]:
    """What to try, and how to speak."""
    language = parts.controls.language
    example = example_command(parts.conversation, parts.skills)
    named = "" if language == "en" else f" The robot understands {LANGUAGES[language].name}."
    lines = [f"Type what the robot should do{f': {example}' if example else ''}.{named}"]
    if parts.voice:
        word = parts.settings.wakeword
        lines.append(f'Or say "{word}", then speak.' if word else "Or speak: it always listens.")
    return [*lines, "Ctrl-C stops the robot. F1 shows commands and keys.", ""]


def _table(rows: Sequence[tuple[str, str]], columns: int) -> str:
    """Rows of a name and what it is, the names of one width."""
    width = max(len(name) for name, _ in rows)
    hanging = " " * (width + 4)
    return "\n".join(
        textwrap.fill(f"  {name:<{width}}  {about}", columns, subsequent_indent=hanging)
        for name, about in rows
    )


def _key_name(key: str) -> str:
    """A key as people write it: "Ctrl-C", "F1"."""
    return "-".join(part.capitalize() for part in key.split("+"))


def example_command(conversation: Conversation, skills: Sequence[Skill]) -> str:
    """A plain command for the first skill that moves the robot; empty if there is none.

    It is one that the templates understand: an example must not fail. Any thread may ask.
    """
    interpreter = conversation.interpreter
    for one in skills:
        told = interpreter.phrases.order(one, _arguments(one)) if one.drives else ""
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
