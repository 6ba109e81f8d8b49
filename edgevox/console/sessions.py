"""Who may reach the console: its sessions, the pairing code, and the address that it is open at.

Each session is a file, so that another process can list and revoke them.

The cookie is ``id.secret``; the file holds the secret's hash only. Removing its file revokes a
session; `LAST_S` ends it.

Pairing makes a session: a code that is shown on the robot lets one browser in, once, for some
minutes. The code lies in a private file, so that a command beside the running robot can make
another one.

Such a command also writes the address at which the console is open to the network. The console then
listens there too, without a restart and also after one. So a person opens a console that nothing
but this machine reached.
"""

import hashlib
import hmac
import itertools
import json
import re
import secrets
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from enum import StrEnum
from ipaddress import ip_address
from pathlib import Path

from edgevox.console.certificates import is_private_address, own_addresses
from edgevox.core.commands import Way
from edgevox.core.files.state_files import StateFiles, write_atomically
from edgevox.core.files.validation import is_number, read_json_object
from edgevox.core.log import get_logger

log = get_logger(__name__)

LAST_S = 90 * 86400.0
_ID = re.compile(r"[0-9a-f]{16}")


class Role(StrEnum):
    """A session's right: to look, hear and stop; or to command as well."""

    VIEWER = "viewer"
    OPERATOR = "operator"

    @property
    def way(self) -> Way:
        """The policy's name for it."""
        return Way.CONSOLE_OPERATOR if self is Role.OPERATOR else Way.CONSOLE_VIEWER


@dataclass(frozen=True, slots=True)
class Session:
    """A paired browser."""

    id: str
    name: str
    role: Role
    hash: str
    began_s: float
    """In Unix seconds."""
    address: str = ""


class Sessions:
    """The sessions of a folder. Cheap to ask: whether one is still there is asked all the time."""

    def __init__(
        self,
        folder: Path,
        now: Callable[[], float] = time.time,
        state: StateFiles | None = None,
    ) -> None:
        self._folder = folder / "sessions"
        self._now = now
        self._state = state or StateFiles()

    def begin(self, role: Role, name: str, address: str) -> tuple[Session, str]:
        """Let somebody in: the session, and the cookie that proves it. Raises `OSError`."""
        self._state.make_folder(self._folder)
        secret = secrets.token_urlsafe(32)
        session = Session(secrets.token_hex(8), name, role, _hash(secret), self._now(), address)
        write_atomically(self._file(session.id), json.dumps(asdict(session)))
        return session, f"{session.id}.{secret}"

    def free_name(self, name: str) -> str:
        """Return the name; with a number, if another session has it."""
        taken = {session.name for session in self.all()}
        numbered = (f"{name} {number}" for number in itertools.count(2))
        return name if name not in taken else next(one for one in numbered if one not in taken)

    def of_cookie(self, cookie: str) -> Session | None:
        """Return the cookie's session; None if it never existed, is revoked, or too old."""
        name, _, secret = cookie.partition(".")
        session = self.find(name)
        if session and hmac.compare_digest(session.hash, _hash(secret)):
            return session
        return None

    def find(self, name: str) -> Session | None:
        """The session of this id, if it is not revoked or too old."""
        if not _ID.fullmatch(name):
            return None
        session = self._read(self._file(name))
        return session if session and session.id == name else None

    def is_there(self, session: Session) -> bool:
        """Return whether the session is neither revoked nor too old."""
        return self._is_young(session) and self._file(session.id).exists()

    def all(self) -> list[Session]:
        """Return the valid sessions, the oldest first."""
        files = self._folder.glob("*.json") if self._folder.is_dir() else ()
        found = [session for file in files if (session := self._read(file))]
        return sorted(found, key=lambda one: one.began_s)

    def revoke(self, name: str) -> bool:
        """End it; whether there was one."""
        if not _ID.fullmatch(name):
            return False
        try:
            self._file(name).unlink()
        except FileNotFoundError:
            return False
        return True

    def _file(self, name: str) -> Path:
        return self._folder / f"{name}.json"

    def _is_young(self, session: Session) -> bool:
        return self._now() - session.began_s < LAST_S

    def _read(self, file: Path) -> Session | None:
        """A session that may not be read counts as none, as one that is damaged does."""
        try:
            session = self._state.read(file, _session, secret=True)
        except OSError as error:
            log.warning("console_session_unreadable", file=file.name, error=repr(error))
            return None
        return session if session and self._is_young(session) else None


def _session(text: str) -> Session:
    """Raises `ValueError`, `TypeError` or `InvalidValue` for a text that holds none."""
    told = read_json_object(text, "session")
    session = Session(**{**told, "role": Role(told["role"])})
    words = (session.id, session.name, session.hash, session.address)
    if not all(isinstance(word, str) for word in words) or not is_number(session.began_s):
        raise TypeError("expected texts, and a number for began_s")
    return session


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest()


CODE_LAST_S = 600.0
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
            "".join(secrets.choice(_ALPHABET) for _ in range(_LENGTH)),
            role,
            self._now() + CODE_LAST_S,
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


@dataclass(frozen=True, slots=True)
class _Opened:
    address: str


class Opened:
    """The file of the address at which the console is open to the network.

    Raises `OSError` where the folder can be neither read nor written.
    """

    def __init__(self, folder: Path, state: StateFiles | None = None) -> None:
        self._file = folder / "opened.json"
        self._state = state or StateFiles()

    def address(self) -> str:
        """The address on which the console shall listen too; empty for none."""
        found = self._state.read(self._file, _opened)
        return found.address if found else ""

    def open(self, address: str) -> None:
        """Open it at this address of the machine."""
        self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_atomically(self._file, json.dumps({"address": address}))

    def close(self) -> bool:
        """Close it; whether it was open."""
        try:
            self._file.unlink()
        except FileNotFoundError:
            return False
        return True


def network_address() -> str:
    """The private IPv4 address by which this machine reaches its network; empty if it has none."""
    found = (one for one in own_addresses() if not ip_address(one).is_loopback)
    return next((one for one in found if ":" not in one), "")


def _opened(text: str) -> _Opened:
    """Raises `ValueError`, `KeyError` or `InvalidValue` for a text that holds no private one."""
    address = str(read_json_object(text, "opened")["address"])
    if not is_private_address(ip_address(address)):
        raise ValueError("expected a private address")
    return _Opened(address)
