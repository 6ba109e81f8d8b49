"""The container's environment, checked and made into what EdgeVox and ROS 2 read.

The table of the variables is `environment.toml`. `EDGEVOX_ROBOT_FOLDER` is one folder with all
files of a robot: each is the value of a variable.
"""

import difflib
import re
import tomllib
from collections.abc import Callable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Literal, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator
from pydantic.fields import FieldInfo

from edgevox.apps.plugins import bring_plugins
from edgevox.apps.robots import ROBOTS, learn_robots
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import ENV_PREFIX, Settings, check_settings, old_name, one_value
from edgevox.ros2.open import installed_middlewares

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
        Variable(variable=variable, setting=name)
        for variable, name in own.items()
        if variable not in named
    ]
    rows += [
        Variable(
            variable=ENV_PREFIX + old_name(info).upper(),
            setting=name,
            about=f"old name of {ENV_PREFIX}{name.upper()}",
        )
        for name, info in Settings.model_fields.items()
        if old_name(info)
    ]
    return {row.variable: row for row in rows}


ENVIRONMENT: Mapping[str, Variable] = _load()
"""All variables by name: those of the file, every other setting's, then the old names."""


FOLDER = "EDGEVOX_ROBOT_FOLDER"
NAMES: Mapping[str, str] = {
    "robot.yaml": "EDGEVOX_ROBOT_FILE",
    "world.yaml": "EDGEVOX_WORLD",
    "places.yaml": "EDGEVOX_LOCATIONS",
    "policy.yaml": "EDGEVOX_POLICY",
    "plugins": "EDGEVOX_PLUGINS",
}
"""Files that may be in the configuration folder, and the variable that names each elsewhere."""
AGENTS_OF: Mapping[str, str] = {"robot.yaml": "robot-external", "world.yaml": "robot-apartment"}
"""The default robot: by the first of these files that is there."""
MOUNTED = Path("/plugins")
"""Plug-ins that are mounted, or part of a derived image: ours has no such folder."""
ALSO = ("interfaces", "scenarios", "README.md")


def from_folder(environment: Mapping[str, str], warn: Callable[[str], None]) -> dict[str, str]:
    """The variables that the folder gives, and `/plugins` where it is there.

    A variable that is set counts more. Raises `InvalidValue` if what `EDGEVOX_ROBOT_FOLDER` names
    is none. A name in it that nobody reads and that is like one that is read goes to `warn`.
    """
    given = environment.get(FOLDER)
    mounted = {NAMES["plugins"]: str(MOUNTED)} if MOUNTED.is_dir() else {}
    return _not_set(mounted | (_values(given, warn) if given else {}), environment)


def _not_set(values: Mapping[str, str], environment: Mapping[str, str]) -> dict[str, str]:
    return {name: value for name, value in values.items() if not environment.get(name)}


def _values(given: str, warn: Callable[[str], None]) -> dict[str, str]:
    folder = Path(given)
    if not folder.is_dir():
        raise InvalidValue(FOLDER, given, "a folder in the container")
    there = sorted(one.name for one in folder.iterdir())
    for name in there:
        if name not in NAMES and name not in ALSO:
            _warn_of(name, warn)
    values = {NAMES[name]: str(folder / name) for name in NAMES if name in there}
    agent = next((AGENTS_OF[name] for name in AGENTS_OF if name in there), None)
    if agent:
        values["EDGEVOX_AGENT"] = agent
    return values


def _warn_of(name: str, warn: Callable[[str], None]) -> None:
    (close, *_) = difflib.get_close_matches(name, [*NAMES, *ALSO], 1) or [""]
    if close:
        warn(f"{FOLDER}: nothing reads {name}; did you mean {close}?")


TRUTH = {"true": "true", "1": "true", "yes": "true", "on": "true"}
TRUTH |= {"false": "false", "0": "false", "no": "false", "off": "false"}
NOT_OURS = re.compile(r"EDGEVOX_(\w+_)?(SERVICE_(HOST|PORT)(_\w+)?|PORT(_\d+_\w+)?)")
"""Variables that Kubernetes sets in every pod for a service whose name begins with edgevox."""
PLUGINS = "EDGEVOX_PLUGINS"
OF_COMPOSE = frozenset({"EDGEVOX_UID", "EDGEVOX_GID"})


def prepared(environment: Mapping[str, str], warn: Callable[[str], None]) -> dict[str, str]:
    """The environment to start a program in: `environment` with the table's variables made good.

    An empty variable counts as not given. Raises `InvalidValue` for the first that is nonsense;
    what is odd but allowed goes to `warn`.
    """
    environment = {**environment, **from_folder(environment, warn)}
    _bring_plugins(environment, warn)
    given = {name: environment[name] for name in ENVIRONMENT if environment.get(name)}
    values = {name: _checked(ENVIRONMENT[name], value, warn) for name, value in given.items()}
    _refuse_contradictions(values)
    for row in ENVIRONMENT.values():
        if row.default and row.target not in _targets(values):
            values[row.variable] = row.default
    _be_quiet_without_sound(values)
    _check_settings(values)
    _find_files(environment)
    warn_of_unknown(environment, warn)
    rest = {name: value for name, value in environment.items() if name not in ENVIRONMENT}
    return rest | _targets(values)


def _bring_plugins(environment: Mapping[str, str], warn: Callable[[str], None]) -> None:
    """Know the robots of plug-ins, before it is asked whether there is one of a name."""
    if folder := environment.get(PLUGINS):
        try:
            plugins = bring_plugins(Path(folder), load=False)
        except InvalidValue as error:
            raise InvalidValue(PLUGINS, error.value, f"{error.expected} ({error.field})") from None
        learn_robots()
        for line in plugins.complaint.splitlines():
            warn(line)


def _targets(values: Mapping[str, str]) -> dict[str, str]:
    """The values under the names by which they are read, a word for "empty" made empty."""
    return {
        ENVIRONMENT[name].target: "" if value == (ENVIRONMENT[name].empty or None) else value
        for name, value in values.items()
    }


def _checked(row: Variable, value: str, warn: Callable[[str], None]) -> str:
    """The value of a variable that is no setting, in the form in which it is read."""
    match row.type:
        case "integer":
            return _integer(row, value, warn)
        case "boolean":
            if (truth := TRUTH.get(value.lower())) is None:
                raise InvalidValue(row.variable, value, row.values)
            return truth
        case "agent":
            value = NO_ROBOT if value == "none" else value
            agents = (*ROBOTS, NO_ROBOT)
            _require(row, value, value in agents, "one of " + ", ".join(agents))
        case "choice":
            _require(row, value, value in row.choices, f"one of {row.values}")
        case "text":
            _require(row, value, bool(re.fullmatch(row.pattern, value)), row.values)
        case "file":
            _require(row, value, Path(value).is_file(), row.values)
        case "folder":
            absolute = Path(value).is_absolute() and not Path(value).is_file()
            _require(row, value, absolute, "the absolute path of a folder")
        case "middleware":
            here = installed_middlewares()
            _require(row, value, value in here, "one of " + (", ".join(here) or "none: no ROS 2"))
    return value


def _require(row: Variable, value: str, good: bool, expected: str) -> None:
    if not good:
        raise InvalidValue(row.variable, value, expected)


def _integer(row: Variable, value: str, warn: Callable[[str], None]) -> str:
    least, most = row.least or 0, row.most or 0
    good = re.fullmatch(r"[0-9]{1,9}", value) is not None and least <= int(value) <= most
    _require(row, value, good, f"a whole number from {least} to {most}")
    number, unwise = int(value), row.unwise
    if unwise and unwise.least <= number <= unwise.most:
        warn(f"{row.variable}={number}: {unwise.because}")
    return str(number)


def _refuse_contradictions(values: Mapping[str, str]) -> None:
    """Refuse two values of one setting that has several names."""
    names: dict[str, str] = {}
    for name in sorted(values, key=lambda name: name != ENVIRONMENT[name].target):
        first = names.setdefault(ENVIRONMENT[name].target, name)
        one_value(name, values[name], first, values[first])


def _be_quiet_without_sound(values: dict[str, str]) -> None:
    """Switch to text mode without microphone and loudspeaker, so that no speech part is loaded."""
    silent = values["EDGEVOX_AUDIO_IN"] == values["EDGEVOX_AUDIO_OUT"] == "none"
    if silent and "EDGEVOX_TEXT_MODE" not in values:
        values["EDGEVOX_TEXT_MODE"] = "true"


def _check_settings(values: Mapping[str, str]) -> None:
    """Refuse what EdgeVox would refuse, by the variable that said it."""
    by_setting = {ENVIRONMENT[name].setting: name for name in values if ENVIRONMENT[name].setting}
    targets = _targets(values)
    try:
        check_settings({s: targets[ENVIRONMENT[name].target] for s, name in by_setting.items()})
    except InvalidValue as error:
        raise InvalidValue(by_setting[error.field], error.value, error.expected) from None


def _find_files(environment: Mapping[str, str]) -> None:
    """Refuse a file of the robot that is not there, before anything starts."""
    for name in NAMES.values():
        value = environment.get(name)
        if value and not Path(value).exists():
            raise InvalidValue(name, value, "a file in the container")


def warn_of_unknown(environment: Mapping[str, str], warn: Callable[[str], None]) -> None:
    """A misspelled variable would else be ignored in silence."""
    known = set(ENVIRONMENT) | OF_COMPOSE
    for name in sorted(environment.keys() - known):
        if name.startswith(ENV_PREFIX) and not NOT_OURS.fullmatch(name):
            (close, *_) = difflib.get_close_matches(name, known, 1) or [""]
            meant = f"; did you mean {close}?" if close else ""
            warn(f"{name} is no variable of EdgeVox and changes nothing{meant}")
