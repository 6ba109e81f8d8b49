"""Slash commands: typed lines that are for the program, not for the robot."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import Skill
from edgevox.apps.console_command import shown_code
from edgevox.apps.folders import console_folder
from edgevox.core.commands import Interrupt, Reset
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import Cause
from edgevox.core.files.text import one_line, printable
from edgevox.core.motion.software_stop import SoftwareStop
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, HasMap
from edgevox.robots.pictures import check_picture, write_picture

MAP_COLUMNS = 60
NO_ROBOT = "No robot is running."


class Leave(Exception):
    """The person wants to leave."""


@dataclass(frozen=True)
class SlashContext:
    """What the commands work on; `columns` is how wide a map may be."""

    conversation: Conversation
    body: Body | None
    columns: int = MAP_COLUMNS
    skills: tuple[Skill, ...] = ()
    software_stop: SoftwareStop = field(kw_only=True)
    settings: Settings | None = None
    """The agent's; None pairs no phone."""


def command_rows() -> list[tuple[str, str]]:
    """Each command as it is typed, and what it does."""
    return [(f"/{name} {one.takes}".rstrip(), one.about) for name, one in COMMANDS.items()]


def _help(_: SlashContext) -> str:
    lines = [f"  {typed:<15} {about}" for typed, about in command_rows()]
    return "\n".join(["Type what you want to say to the robot, or a command:", *lines])


def _picture(context: SlashContext, name: str) -> str:
    if context.body is None:
        return NO_ROBOT
    file = Path(name or f"{context.body.name}.png").expanduser()
    try:
        write_picture(check_picture(context.body, file), file)
    except EdgeVoxError as error:
        return str(error)
    return f"Picture saved: {file.absolute()}"


def _map(context: SlashContext) -> str:
    if isinstance(context.body, HasMap):
        return context.body.draw_map(context.columns)
    return f"{context.body.name} has no map." if context.body else NO_ROBOT


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
    return "Robot stopped."


def _resume(context: SlashContext) -> str:
    if not context.software_stop.state.engaged:
        return "No software stop is in force."
    context.software_stop.resume("the terminal")
    return "The robot may move again."


def _reset(context: SlashContext) -> str:
    context.conversation.submit(Reset())
    return "Conversation reset."


def _restart(context: SlashContext) -> str:
    if context.body is None:
        return NO_ROBOT
    context.conversation.submit(Interrupt("world reset", cause=Cause.TERMINAL))
    context.body.reset()
    return "World reset."


def _pair(context: SlashContext, words: str) -> str:
    """Show a QR code; raises `EdgeVoxError` for the reason why there is none."""
    from edgevox.apps.console.phone import NotOpen, pair_phone
    from edgevox.console.sessions import Role

    if words not in ("", "open"):
        raise InvalidValue("/pair", words, "open, or nothing")
    settings = context.settings
    if settings is None or not settings.serves_console:
        return "This robot serves no console."
    try:
        one = pair_phone(settings, console_folder(settings), Role.OPERATOR, lambda _: bool(words))
    except NotOpen as error:
        return f"{error}: /pair open"
    except OSError as error:
        raise EdgeVoxError(f"console_folder: {error.strerror or error}") from None
    return shown_code(one.url, one.code.code, one.code.shown, str(one.code.role), phone=True)


def _quit(_: SlashContext) -> str:
    raise Leave


@dataclass(frozen=True)
class SlashCommand:
    """A slash command: what it does, in a sentence, and how.

    `takes` names what may follow it; `run` gets that text as its second argument then. One that
    `stops` never waits for what was typed before it; nothing that is typed waits for a `slow` one.
    """

    about: str
    run: Callable[..., str]
    takes: str = ""
    stops: bool = False
    slow: bool = False
    sheet: bool = False
    """Whether a full screen shows the answer by itself: a picture made of characters."""


COMMANDS: Mapping[str, SlashCommand] = {
    "help": SlashCommand("show this help", _help),
    "map": SlashCommand("show the map with the robot", _map),
    "picture": SlashCommand("save a picture of the robot as PNG", _picture, "[FILE]", slow=True),
    "state": SlashCommand("show the robot's state", _state),
    "skills": SlashCommand("list the robot's skills", _skills),
    "stop": SlashCommand("stop the robot and its voice", _stop, stops=True),
    "resume": SlashCommand("lift the software stop", _resume),
    "reset": SlashCommand("stop and reset the conversation", _reset, stops=True),
    "restart": SlashCommand("reset the robot and its world", _restart),
    "pair": SlashCommand(
        "let a phone in; open: also open the console to it", _pair, "[open]", slow=True, sheet=True
    ),
    "quit": SlashCommand("exit", _quit),
}


def is_stop(line: str, context: SlashContext) -> bool:
    """Whether a line that is typed stops the robot, in words or by a slash command."""
    if not line.startswith("/"):
        return context.conversation.is_stop(line)
    name, rest = _split(line)
    return name in COMMANDS and COMMANDS[name].stops and not rest


def is_slow(line: str) -> bool:
    """Whether a slash command may take long."""
    name = _split(line)[0] if line.startswith("/") else ""
    return name in COMMANDS and COMMANDS[name].slow


def run_command(line: str, context: SlashContext) -> str:
    """Run a line that begins with a slash; what it prints. Raises `Leave`."""
    name, rest = _split(line)
    command = COMMANDS.get(name)
    if command is None:
        return f"/{one_line(name)}: unknown command; expected one of /{', /'.join(COMMANDS)}"
    if rest and not command.takes:
        return f"/{name}: got {rest!r}, expected nothing after it"
    try:
        return printable(command.run(context, rest) if command.takes else command.run(context))
    except EdgeVoxError as error:
        return printable(str(error))


def is_sheet(line: str) -> bool:
    """Whether the answer to a slash command is a picture made of characters."""
    name = _split(line)[0]
    return name in COMMANDS and COMMANDS[name].sheet


def _split(line: str) -> tuple[str, str]:
    """The command's name, and what follows it."""
    name, _, rest = line[1:].strip().partition(" ")
    return name.lower(), rest.strip()
