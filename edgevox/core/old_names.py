"""Names that settings had before: flags, variables and keys of a TOML file that go on working.

A setting says its own in its field's ``json_schema_extra``: `old_name` for all three, and
`old_flag` where the flag was called otherwise.
"""

from collections.abc import Mapping
from typing import Any

from pydantic.fields import FieldInfo

from edgevox.core.errors import InvalidValue

ENV_PREFIX = "EDGEVOX_"
Fields = Mapping[str, FieldInfo]


def old_name(info: FieldInfo) -> str:
    """What the setting was called; empty for most."""
    return _extra(info, "old_name")


def old_flag(info: FieldInfo) -> str:
    """What its flag was called; empty for most."""
    return _extra(info, "old_flag") or old_name(info)


def one_value(old: str, value: object, new: str, other: object) -> None:
    """Raises `InvalidValue`, with both names, if one setting has two values."""
    if value != other:
        raise InvalidValue(old, value, f"{other!r}, as {new} says, or only one")


def by_old_variables(environment: Mapping[str, str], fields: Fields) -> dict[str, Any]:
    """The settings that the environment gives by an old name.

    Raises `InvalidValue` for one that it gives by its new name too, and another value.
    """
    given = {name.upper(): value for name, value in environment.items()}
    values: dict[str, Any] = {}
    for name, info in fields.items():
        old, new = ENV_PREFIX + old_name(info).upper(), ENV_PREFIX + name.upper()
        if old_name(info) and old in given:
            values[name] = given[old]
            one_value(old, given[old], new, given.get(new, given[old]))
    return values


def by_new_keys(written: Mapping[str, Any], fields: Fields) -> dict[str, Any]:
    """A TOML file's settings, those with an old key under the new one.

    Raises `InvalidValue` for one that has both keys, and another value by each.
    """
    values = dict(written)
    for name, info in fields.items():
        old = old_name(info)
        if old and old in values:
            value = values.pop(old)
            one_value(old, value, name, values.setdefault(name, value))
    return values


def _extra(info: FieldInfo, key: str) -> str:
    extra = info.json_schema_extra
    return str(extra.get(key, "")) if isinstance(extra, dict) else ""
