"""`EdgeVoxError`, the root of the errors that people read; `Refusal`, the reasons to refuse.

The tree, with the main subclasses and the packages that define them:

- `EdgeVoxError`
    - `InvalidValue` (core): a field holds a wrong value
        - `InvalidFile` (core): several fields of a file do
        - `WrongArgument` (agent), `UnknownModel` (models)
    - `SkillFailed` (agent): a skill cannot be done; its reason may be said aloud
        - `Denied` (agent): the policy forbids it
        - `OutOfReach`, `InTheWay` (robots)
    - `ModelFailed` (agent): the language model gave no answer
        - `ModelBusy` (agent)
    - `ServerFailed` (core): a server of models, hearing or speech gave no usable answer
        - `ServerBusy`, `Unreachable`, `Unusable`, `RequestRefused`, `OddAnswer` (core)
    - `ModelMissing`, `FetchFailed`, `SourceFailed`, `StoreNotWritable` (models): files of models
    - `DeviceMissing`, `SynthesisFailed`, `EndOfSound` (voice)
    - `RosBridgeFailed`, `InterfaceMissing` (ros2)
    - `StreamStopped`, `UnusableLanguage` (core)

Some exceptions are no `EdgeVoxError`; their callers catch them by name: `Cancelled` (core),
`NodeBusy` and `TookTooLong` (ros2), `NotPermitted` (console) and `Leave` (apps) derive from
`Exception`, `Terminated` (apps) from `BaseException`, as `KeyboardInterrupt` does.
"""

import math
from collections.abc import Sequence
from enum import StrEnum

from edgevox.core.files.text import one_line


class Refusal(StrEnum):
    """Reasons to refuse a request. Refusals are counted and logged under these names."""

    TOO_LONG = "too_long"
    TOO_MANY = "too_many"
    NOT_FINITE = "not_finite"
    IMPLAUSIBLE = "implausible"
    FORBIDDEN = "forbidden"
    INVALID = "invalid"


class EdgeVoxError(Exception):
    """The root of EdgeVox's errors. The message names the problem, the value and a right value."""


class InvalidValue(EdgeVoxError):
    """A named field holds a value that cannot be honoured.

    The message reads ``field: got value, expected expectation``; the parts stay available so that a
    face (a ROS 2 parameter result, the terminal) can say them its own way.
    """

    def __init__(
        self, field: str, value: object, expected: str, reason: Refusal = Refusal.INVALID
    ) -> None:
        self.reason = reason
        self.field = field
        self.value = value
        self.expected = expected
        super().__init__(f"{one_line(field)}: got {shorten(value)}, expected {one_line(expected)}")

    @property
    def problems(self) -> "Sequence[InvalidValue]":
        """All that is wrong, each for a line of its own."""
        return (self,)


class InvalidFile(InvalidValue):
    """Several fields of a file hold wrong values. As one error, it is the first of them."""

    def __init__(self, problems: Sequence[InvalidValue]) -> None:
        first = problems[0]
        super().__init__(first.field, first.value, first.expected, first.reason)
        self._problems = tuple(problems)

    @property
    def problems(self) -> Sequence[InvalidValue]:
        return self._problems


def finite(field: str, value: float) -> float:
    """The value as a float. Raises `InvalidValue` if it is not finite."""
    if not math.isfinite(value):
        raise InvalidValue(field, value, "a finite number")
    return float(value)


def shorten(value: object, limit: int = 80) -> str:
    """``repr`` of a value, cut in the middle so that a message stays one readable line."""
    text = repr(value)
    if len(text) <= limit:
        return text
    keep = (limit - 1) // 2
    return f"{text[:keep]}…{text[-keep:]}"


def install_extra(extra: str) -> str:
    """The command that installs an extra, and the folder to run it in.

    From EdgeVox's own folder, and never by a name that a package index looks up: there the name of
    this import package belongs to somebody else.
    """
    return f"pip install '.[{extra}]' in EdgeVox's folder"
