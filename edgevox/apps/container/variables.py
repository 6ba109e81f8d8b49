"""The table of the container's environment variables, read from `environment.toml`."""

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Literal, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator
from pydantic.fields import FieldInfo

from edgevox.apps.robots import ROBOTS
from edgevox.core.settings import ENV_PREFIX, Settings, old_name

NO_ROBOT = "edgevox"
"""The agent without a robot."""
AGENTS = (*ROBOTS, NO_ROBOT)

Type = Literal[
    "integer", "boolean", "choice", "text", "file", "folder", "agent", "middleware", "setting"
]


class UnwiseRange(BaseModel):
    """A range of numbers that is allowed, with what speaks against it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    least: int = Field(alias="from")
    most: int = Field(alias="to")
    because: str


class Variable(BaseModel):
    """A variable of the container."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    variable: str
    type: Type = "setting"
    setting: str = ""
    default: str = ""
    """The container's own default; empty if it sets none."""
    empty: str = ""
    shown: str = ""
    about: str = ""
    allowed: str = ""
    choices: tuple[str, ...] = ()
    pattern: str = ""
    least: int | None = None
    most: int | None = None
    unwise: UnwiseRange | None = None
    listed: bool = True
    """False for a variable that only follows from the settings."""

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.type == "setting") != bool(self.setting):
            raise ValueError("a row has either a type or a setting")
        if self.setting and self.setting not in Settings.model_fields:
            raise ValueError(f"no such setting: {self.setting}")
        if not self.sentence:
            raise ValueError("a row says what it is about")
        return self

    @property
    def target(self) -> str:
        """The variable that EdgeVox itself reads."""
        return ENV_PREFIX + self.setting.upper() if self.setting else self.variable

    @property
    def sentence(self) -> str:
        """Its description."""
        return self.about or (self._field.description or "" if self.setting else "")

    @property
    def default_text(self) -> str:
        """Its default, for people; empty without one."""
        if self.shown:
            return self.shown
        if self.default or not self.setting:
            return f"`{self.default}`" if self.default else ""
        value = self._field.default
        return "" if value in (None, "") else f"`{str(value).lower()}`"

    @property
    def values(self) -> str:
        """Its allowed values, for people; empty if any is."""
        if self.allowed:
            return self.allowed
        match self.type:
            case "integer":
                return f"{self.least} to {self.most}"
            case "boolean":
                return "true or false"
            case "choice" | "agent":
                return ", ".join(self.choices or AGENTS)
            case "file":
                return "a file that exists"
            case "folder":
                return "an absolute path"
            case "setting":
                return _allowed(self._field)
        return ""

    @property
    def _field(self) -> FieldInfo:
        return Settings.model_fields[self.setting]


def _allowed(field: FieldInfo) -> str:
    """Return a setting's allowed values, from its type and bounds."""
    if field.annotation is bool:
        return "true or false"
    if get_origin(field.annotation) is Literal:
        return ", ".join(str(one) or "empty" for one in get_args(field.annotation))
    bounds = {
        name: getattr(one, name)
        for one in field.metadata
        for name in ("ge", "gt", "le", "lt")
        if getattr(one, name, None) is not None
    }
    words = {"ge": "from", "gt": "above", "le": "to", "lt": "below"}
    return " ".join(f"{words[name]} {bounds[name]}" for name in words if name in bounds)


def _load() -> Mapping[str, Variable]:
    text = files("edgevox.apps.container").joinpath("environment.toml").read_text(encoding="utf-8")
    adapter = TypeAdapter(list[Variable])
    rows = adapter.validate_python(
        [{"variable": name, **row} for name, row in tomllib.loads(text).items()]
    )
    named = {row.variable for row in rows}
    own = {ENV_PREFIX + name.upper(): name for name in Settings.model_fields}
    rows += [
        Variable(variable=variable, setting=name, listed=False)
        for variable, name in own.items()
        if variable not in named
    ]
    rows += [
        Variable(
            variable=ENV_PREFIX + old_name(info).upper(),
            setting=name,
            about=f"old name of {ENV_PREFIX}{name.upper()}",
            listed=False,
        )
        for name, info in Settings.model_fields.items()
        if old_name(info)
    ]
    return {row.variable: row for row in rows}


ENVIRONMENT: Mapping[str, Variable] = _load()
"""All variables by name: those of the file, every other setting's, then the old names."""
