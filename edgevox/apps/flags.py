"""Command line flags made from the settings: one declaration, one help text, one validation."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from edgevox.core.settings import ENV_PREFIX, Settings, old_flag

FIRST = (
    "language",
    "text_mode",
    "audio_in",
    "audio_out",
    "wakeword",
    "llm",
    "ros2",
    "agent_namespace",
    "robot_namespace",
    "robot_file",
)
"""The settings that most people need; their flags stand first in the help."""
GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "conversation": (
            "voice",
            "muted",
            "confirm",
            "simple_ui",
            "follow_up_s",
            *("answer_group", "spoken_name"),
        ),
        "robot": (
            *("robot_", "world", "model_source", "mjcf", "seed", "render", "max_"),
            *("locations", "places", "pictures", "skills", "plugins", "policy"),
        ),
        "ROS 2": ("ros2", "agent_", "odom_frame", "frame_prefix", "publish_clock"),
        "hearing and speaking": (
            *("audio_", "wakeword", "keep_audio", "stop_spotter", "echo", "stt_", "tts_"),
        ),
        "language model": ("llm",),
        "operation": ("health_", "metrics_", "log_", "leave_s", "drain_s"),
        "console": ("console",),
    }
)
"""The groups of the other flags in the help, by how their settings begin."""


def group_of(name: str) -> str:
    """The group of a setting's flag. Raises `KeyError` for a setting that is in none."""
    if name in FIRST:
        return "first of all"
    for group, starts in GROUPS.items():
        if name.startswith(starts):
            return group
    raise KeyError(name)


def add_flags(parser: argparse.ArgumentParser, fields: Sequence[str] | None = None) -> None:
    """A flag for every setting named in `fields`, all of them by default, and ``--config``.

    More than a few stand in groups, the first of all first.
    """
    parser.add_argument("--config", type=Path, metavar="FILE", help="TOML file with settings")
    names = sorted(fields or Settings.model_fields, key=lambda name: name not in FIRST)
    groups: dict[str, argparse._ActionsContainer] = {}
    for name in names:
        title = group_of(name)
        if title not in groups:
            few = len(names) <= len(FIRST)
            groups[title] = parser if few else parser.add_argument_group(title)
        _add(groups[title], name, Settings.model_fields[name])


def given_flags(arguments: argparse.Namespace) -> dict[str, Any]:
    """Only those settings that the command line gave."""
    return {name: value for name, value in vars(arguments).items() if name in Settings.model_fields}


def _add(parser: argparse._ActionsContainer, name: str, info: FieldInfo) -> None:
    names = _flag_names(name, info)
    help_text = f"{info.description} ({ENV_PREFIX}{name.upper()})"
    if info.annotation is bool:
        parser.add_argument(
            *names,
            dest=name,
            action=argparse.BooleanOptionalAction,
            default=argparse.SUPPRESS,
            help=help_text,
        )
        return
    default = "" if info.default in (None, "") else f" [default: {info.default}]"
    parser.add_argument(
        *names,
        dest=name,
        action=_ByEitherName if len(names) > 1 else "store",
        default=argparse.SUPPRESS,
        metavar=_metavar(name, info),
        help=(help_text + default).replace("%", "%%"),
    )


class _ByEitherName(argparse.Action):
    """Takes a value by the setting's flag or its old name; two different values are refused.

    The name is kept in the result, since a parser may be used twice.
    """

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        before = getattr(namespace, f"flag of {self.dest}", option_string)
        if before != option_string and getattr(namespace, self.dest) != values:
            other = getattr(namespace, self.dest)
            parser.error(f"{option_string}: got {values!r}, but {before} says {other!r}")
        setattr(namespace, f"flag of {self.dest}", option_string)
        setattr(namespace, self.dest, values)


def _flag_names(name: str, info: FieldInfo) -> Sequence[str]:
    """After the field, and after what it was called before."""
    names = [name, old_flag(info)] if old_flag(info) else [name]
    return ["--" + one.replace("_", "-") for one in names]


def _metavar(name: str, info: FieldInfo) -> str:
    if get_origin(info.annotation) is Literal:
        return "|".join(word or "''" for word in get_args(info.annotation))
    if isinstance(info.annotation, UnionType) and Path in get_args(info.annotation):
        return "FOLDER" if (info.description or "").startswith("folder") else "FILE"
    return name.rpartition("_")[2].upper()
