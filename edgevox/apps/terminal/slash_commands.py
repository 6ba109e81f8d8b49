"""The slash commands: typed lines that are not for the robot."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import Skill
from edgevox.apps.agent.snapshot import check_picture, write_picture
from edgevox.core.commands import Interrupt, Reset
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import Cause
from edgevox.core.files.text import one_line, printable
from edgevox.robots.capabilities import Body, HasMap

MAP_COLUMNS = 60
NO_ROBOT = "there is no robot here"


class Leave(Exception):
    """The person wants to leave."""


@dataclass(frozen=True)
class SlashContext:
    """The objects that the commands work on; `columns` is the greatest width of a map."""

    conversation: Conversation
    body: Body | None
    columns: int = MAP_COLUMNS
    skills: tuple[Skill, ...] = ()


def _help(_: SlashContext) -> str:
    names = {f"/{name} {command.takes}": command.about for name, command in COMMANDS.items()}
    lines = [f"  {name:<15} {about}" for name, about in names.items()]
    return "\n".join(["Type what you would say to the robot, or:", *lines])


def _picture(context: SlashContext, name: str) -> str:
    if context.body is None:
        return NO_ROBOT
    file = Path(name or f"{context.body.name}.png").expanduser()
    try:
        write_picture(check_picture(context.body, file), file)
    except EdgeVoxError as error:
        return str(error)
    return f"written to {file.absolute()}"


def _map(context: SlashContext) -> str:
    if isinstance(context.body, HasMap):
        return context.body.draw_map(context.columns)
    return f"{context.body.name} has no map" if context.body else NO_ROBOT


def _state(context: SlashContext) -> str:
    if context.body is None:
        return NO_ROBOT
    return json.dumps(context.body.state(), indent=2, ensure_ascii=False)


def _skills(context: SlashContext) -> str:
    return "\n".join(
        one_line(f"  {s.name}({', '.join(s.arguments_model.model_fields)})  {s.description}")
        for s in context.skills
    )


def _stop(context: SlashContext) -> str:
    context.conversation.submit(Interrupt("typed /stop", cause=Cause.TERMINAL))
    return "stopped"


def _reset(context: SlashContext) -> str:
    context.conversation.submit(Reset())
    return "forgotten"


def _restart(context: SlashContext) -> str:
    if context.body is None:
        return NO_ROBOT
    context.conversation.submit(Interrupt("the world was put back", cause=Cause.TERMINAL))
    context.body.reset()
    return "put back"


def _quit(_: SlashContext) -> str:
    raise Leave


@dataclass(frozen=True)
class SlashCommand:
    """A slash command."""

    about: str
    """Its effect, in a sentence."""
    run: Callable[..., str]
    takes: str = ""
    """Names the text that may follow; `run` then gets it as its second argument."""
    stops: bool = False
    """It never waits for earlier lines."""
    slow: bool = False
    """No later line waits for it."""


COMMANDS: Mapping[str, SlashCommand] = {
    "help": SlashCommand("show this", _help),
    "map": SlashCommand("draw the world with the robot in it", _map),
    "picture": SlashCommand("write a picture of the robot as PNG", _picture, "[FILE]", slow=True),
    "state": SlashCommand("show the robot's state", _state),
    "skills": SlashCommand("list what the robot can do", _skills),
    "stop": SlashCommand("stop talking and moving", _stop, stops=True),
    "reset": SlashCommand("forget the conversation and stop", _reset, stops=True),
    "restart": SlashCommand("put the robot and its world back to the start", _restart),
    "quit": SlashCommand("leave", _quit),
}


def is_stop(line: str, context: SlashContext) -> bool:
    """Return whether a typed line stops the robot, in words or by a slash command."""
    if not line.startswith("/"):
        return context.conversation.is_stop(line)
    name, rest = _split(line)
    return name in COMMANDS and COMMANDS[name].stops and not rest


def is_slow(line: str) -> bool:
    """Return whether a slash command may take long."""
    name = _split(line)[0] if line.startswith("/") else ""
    return name in COMMANDS and COMMANDS[name].slow


def run_command(line: str, context: SlashContext) -> str:
    """Run a line that begins with a slash; what it prints. Raises `Leave`."""
    name, rest = _split(line)
    command = COMMANDS.get(name)
    if command is None:
        return f"/{one_line(name)}: no such command; expected one of /{', /'.join(COMMANDS)}"
    if rest and not command.takes:
        return f"/{name}: got {rest!r}, expected nothing after it"
    return printable(command.run(context, rest) if command.takes else command.run(context))


def _split(line: str) -> tuple[str, str]:
    """The command's name, and what follows it."""
    name, _, rest = line[1:].strip().partition(" ")
    return name.lower(), rest.strip()
