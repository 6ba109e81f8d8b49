"""What a person can type that is not for the robot: lines that begin with a slash."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from edgevox.agent.conversation import Conversation
from edgevox.core.commands import Interrupt, Reset
from edgevox.robots.capabilities import Body, HasMap

MAP_COLUMNS = 60


class Leave(Exception):
    """The person wants to leave."""


@dataclass(frozen=True)
class Desk:
    """What the commands work on."""

    conversation: Conversation
    body: Body


def _help(_: Desk) -> str:
    lines = [f"  /{name:<6} {command.about}" for name, command in COMMANDS.items()]
    return "\n".join(["Type what you would say to the robot, or:", *lines])


def _map(desk: Desk) -> str:
    if isinstance(desk.body, HasMap):
        return desk.body.draw_map(MAP_COLUMNS)
    return f"{desk.body.name} has no map"


def _state(desk: Desk) -> str:
    return json.dumps(desk.body.state(), indent=2, ensure_ascii=False)


def _skills(desk: Desk) -> str:
    return "\n".join(
        f"  {s.name}({', '.join(s.arguments_model.model_fields)})  {s.description}"
        for s in desk.body.skills
    )


def _stop(desk: Desk) -> str:
    desk.conversation.submit(Interrupt("typed /stop"))
    return "stopped"


def _reset(desk: Desk) -> str:
    desk.conversation.submit(Reset())
    return "forgotten"


def _quit(_: Desk) -> str:
    raise Leave


@dataclass(frozen=True)
class SlashCommand:
    """A slash command: what it does, in a sentence, and how."""

    about: str
    run: Callable[[Desk], str]


COMMANDS: Mapping[str, SlashCommand] = {
    "help": SlashCommand("show this", _help),
    "map": SlashCommand("draw the world with the robot in it", _map),
    "state": SlashCommand("show the robot's state", _state),
    "skills": SlashCommand("list what the robot can do", _skills),
    "stop": SlashCommand("stop talking and moving", _stop),
    "reset": SlashCommand("forget the conversation and stop", _reset),
    "quit": SlashCommand("leave", _quit),
}


def run_command(line: str, desk: Desk) -> str:
    """Run a line that begins with a slash; what it prints. Raises `Leave`."""
    name = line[1:].strip().lower()
    if name not in COMMANDS:
        return f"/{name}: no such command; expected one of /{', /'.join(COMMANDS)}"
    return COMMANDS[name].run(desk)
