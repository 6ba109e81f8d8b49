"""Command line flags made from the settings: one declaration, one help text, one validation."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from edgevox.core.settings import ENV_PREFIX, Settings


def add_flags(parser: argparse.ArgumentParser, fields: Sequence[str] | None = None) -> None:
    """A flag for every setting named in `fields`, all of them by default, and ``--config``."""
    parser.add_argument("--config", type=Path, metavar="FILE", help="TOML file with settings")
    for name in fields or Settings.model_fields:
        _add(parser, name, Settings.model_fields[name])


def given_flags(arguments: argparse.Namespace) -> dict[str, Any]:
    """Only those settings that the command line gave."""
    return {name: value for name, value in vars(arguments).items() if name in Settings.model_fields}


def _add(parser: argparse.ArgumentParser, name: str, info: FieldInfo) -> None:
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
        default=argparse.SUPPRESS,
        metavar=_metavar(name, info),
        help=(help_text + default).replace("%", "%%"),
    )


def _flag_names(name: str, info: FieldInfo) -> Sequence[str]:
    """After the field, unless the field names another in its ``json_schema_extra``.

    An `old_flag` there is one that it had before, and which goes on working.
    """
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    names = [
        str(extra.get("flag", name)),
        *([str(extra["old_flag"])] if "old_flag" in extra else []),
    ]
    return ["--" + one.replace("_", "-") for one in names]


def _metavar(name: str, info: FieldInfo) -> str:
    if get_origin(info.annotation) is Literal:
        return "|".join(word or "''" for word in get_args(info.annotation))
    if isinstance(info.annotation, UnionType) and Path in get_args(info.annotation):
        return "FILE"
    return name.rpartition("_")[2].upper()
