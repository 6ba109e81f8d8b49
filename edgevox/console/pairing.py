"""Pairing: a code that is shown on the robot lets one browser in, once, for some minutes.

The code lies in a private file, so that a command beside the running robot can make another one.
"""

import hmac
import json
import secrets
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from edgevox.console.sessions import Role
from edgevox.core.files.atomic_file import write_atomically
from edgevox.core.files.json_reader import read_json_object
from edgevox.core.files.state_files import StateFiles

LAST_S = 600.0
MOST_WRONG = 10
"""Wrong attempts after which a code is void."""
_ALPHABET = "23456789ABCDEFGHJKMNPQRSTVWXYZ"
"""Letters and digits that are not mistaken for each other."""
_LENGTH = 8


@dataclass(frozen=True, slots=True)
class Code:
    """A pairing code."""

    code: str
    role: Role
    """The role that it gives to a browser."""
    until_s: float
    """The end of its validity, in Unix seconds."""

    @property
    def shown(self) -> str:
        """The code as a person reads it."""
        return f"{self.code[:4]}-{self.code[4:]}"


class Pairing:
    """The one code there is, if there is one."""

    def __init__(
        self,
        folder: Path,
        now: Callable[[], float] = time.time,
        state: StateFiles | None = None,
    ) -> None:
        self._file = folder / "pairing.json"
        self._now = now
        self._state = state or StateFiles()
        self._wrong: tuple[str, int] = ("", 0)

    def offer(self, role: Role = Role.OPERATOR) -> Code:
        """Make a code in place of the one there was. Raises `OSError`."""
        self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._state.read(
            self._file, _code, secret=True
        )  # what is no file there is kept aside first
        code = Code(
            "".join(secrets.choice(_ALPHABET) for _ in range(_LENGTH)), role, self._now() + LAST_S
        )
        write_atomically(self._file, json.dumps(asdict(code)))
        return code

    def redeem(self, told: str) -> Role | None:
        """The role that this code gives, which it does once; None if it is not the code.

        Raises `OSError` where it cannot be struck out: then it lets nobody in.
        """
        code = self._read()
        if not code:
            return None
        plain = told.upper().replace("-", "").replace(" ", "")
        if not hmac.compare_digest(code.code.encode(), plain.encode("utf-8", "replace")):
            self._count_wrong(code)
            return None
        self._file.unlink(missing_ok=True)
        return code.role

    def _count_wrong(self, code: Code) -> None:
        known, count = self._wrong
        self._wrong = (code.code, count + 1 if known == code.code else 1)
        if self._wrong[1] >= MOST_WRONG:
            self._file.unlink(missing_ok=True)

    def _read(self) -> Code | None:
        code = self._state.read(self._file, _code, secret=True)
        return code if code and self._now() < code.until_s else None


def _code(text: str) -> Code:
    """Raises `ValueError`, `TypeError`, `KeyError` or `InvalidValue` for a text that holds none."""
    told = read_json_object(text, "pairing")
    return Code(str(told["code"]), Role(told["role"]), float(told["until_s"]))
