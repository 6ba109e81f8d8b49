"""`edgevox-agent`: an agent with a body, on the terminal and on ROS 2."""

import argparse
import logging
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from edgevox import __version__
from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.base import LanguageModel
from edgevox.agent.llm.primer import Primer
from edgevox.apps.ending import Ending, Terminated
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.queries import available_voices, build_queries
from edgevox.apps.robots import ROBOTS, build_agents, build_body
from edgevox.apps.switchboard import Switchboard
from edgevox.apps.terminal import run_terminal
from edgevox.apps.terminal.commands import Desk
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import ControlChanged
from edgevox.core.settings import Settings, load_settings
from edgevox.models import locate
from edgevox.robots.capabilities import Body
from edgevox.ros2 import Bridge, Wiring, open_bridge, split_ros_args

USAGE_ERROR = 2


def main(argv: Sequence[str] | None = None) -> int:
    """Run the agent; the process's exit code."""
    own, ros = split_ros_args(sys.argv[1:] if argv is None else argv)
    parser = _parser()
    arguments = parser.parse_args(own)
    try:
        settings = load_settings(given_flags(arguments), arguments.config)
        if not settings.text_mode:
            raise InvalidValue("text_mode", False, "--text-mode, while there is no sound yet")
        logging.basicConfig(
            level=settings.log_level.upper(), format="%(levelname)s %(name)s: %(message)s"
        )
        body = build_body(arguments.robot, settings)
    except EdgeVoxError as error:
        parser.exit(USAGE_ERROR, f"{parser.prog}: {error}\n")
    try:
        _run(settings, body, ros)
    except InvalidValue as error:
        parser.exit(USAGE_ERROR, f"{parser.prog}: {error}\n")
    except EdgeVoxError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    except (Terminated, KeyboardInterrupt):
        pass
    return 0


def _run(settings: Settings, body: Body, ros_args: Sequence[str]) -> None:
    """Put the parts together, run until somebody leaves, and take them apart in reverse order."""
    bus = Bus()
    agents = build_agents(body)
    with ExitStack() as stack:
        controls = Controls(
            bus,
            language=settings.language,
            voice=settings.voice,
            muted=settings.muted,
            voices=available_voices,
        )
        model_path = _model_path(settings)
        model = _open_model(settings, model_path) if model_path else None
        if model:
            stack.callback(model.close)
        conversation = Conversation(
            agents, bus, halt=body.halt, model=model, language=settings.language
        )
        bus.subscribe(ControlChanged, lambda change: _follow(conversation, change))
        queries = build_queries(controls, model_path)
        switchboard = Switchboard(conversation, controls, queries, bus)
        with Ending() as ending:
            _start(stack, body)
            if settings.ros2:
                wiring = Wiring(
                    settings, bus, switchboard.submit, controls, queries, body, conversation
                )
                bridge = open_bridge(wiring, ros_args)
                _start(stack, bridge)
                print(f"ROS 2: {bridge.where}", flush=True)
            if model:
                _start(stack, Primer(model, conversation.mind.chat()))
            _start(stack, conversation)  # last, so that its first state is heard on the bridge
            print(f"{body.name} is ready. /help shows what can be typed.", flush=True)
            run_terminal(bus, Desk(conversation, body), ending, plain=settings.simple_ui)


def _start(stack: ExitStack, part: Body | Conversation | Bridge | Primer) -> None:
    stack.callback(part.close)
    part.start()


def _follow(conversation: Conversation, change: ControlChanged) -> None:
    if change.name == "language":
        conversation.set_language(str(change.value))


def _model_path(settings: Settings) -> Path | None:
    if settings.llm == "none":
        return None
    path = Path(settings.llm)
    return path if path.suffix == ".gguf" else locate(settings.llm)


def _open_model(settings: Settings, path: Path) -> LanguageModel:
    from edgevox.agent.llm.factory import load_model

    print(f"loading {path.name} ...", flush=True)
    return load_model(
        path,
        backend=settings.llm_backend,
        context_tokens=settings.llm_context,
        threads=settings.llm_threads or None,
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox-agent",
        description="A voice agent with a robot's body.",
        epilog="Settings come from a --config file, then EDGEVOX_* variables, then these flags.",
    )
    parser.add_argument("--version", action="version", version=__version__)
    robots = "; ".join(f"{name}: {about}" for name, (about, _) in ROBOTS.items())
    parser.add_argument("robot", choices=ROBOTS, metavar="ROBOT", help=robots)
    add_flags(parser)
    return parser
