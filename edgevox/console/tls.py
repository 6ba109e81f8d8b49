"""The console's URL and its encryption, and the replacement of a certificate that ends."""

import hashlib
import socket
import ssl
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, open_file

_EVERYWHERE = ("0.0.0.0", "::", "")  # noqa: S104


def console_url(host: str, port: int, secure: bool, names: str = "") -> str:
    """The address of the page.

    Where it listens on all addresses of the machine, that is by the first of its `names`, with
    commas between, or else by the machine's.
    """
    first = names.partition(",")[0].strip()
    named = (first or socket.gethostname()) if host in _EVERYWHERE else host
    shown = f"[{named}]" if ":" in named else named
    return f"{'https' if secure else 'http'}://{shown}:{port}"


@dataclass(frozen=True, slots=True)
class Tls:
    """The files of the encryption."""

    certificate: Path
    key: Path
    authority: Path | None = None
    """The authority's certificate, which pages may download."""
    renew: Callable[[], object] = field(default=lambda: None, compare=False)
    """Renews files that end soon; raises `InvalidValue` and `OSError`."""


class CurrentTls:
    """The encryption of new connections. Raises `InvalidValue` for files that do not fit.

    An open connection keeps its own.
    """

    def __init__(self, tls: Tls) -> None:
        self._tls = tls
        self._read = self._digest()
        self.context = _context(tls)

    def look(self) -> bool:
        """Renew what ends soon, and take files that are others; whether there are.

        Raises `InvalidValue` and `OSError`, and then all stays as it was.
        """
        self._tls.renew()
        read = self._digest()
        if read == self._read:
            return False
        self.context = _context(self._tls)  # a whole one, never the one in use half changed
        self._read = read
        return True

    def _digest(self) -> bytes:
        files = (
            _bytes(self._tls.certificate, "console_certificate"),
            _bytes(self._tls.key, "console_key"),
        )
        return hashlib.sha256(b"\0".join(files)).digest()


def _bytes(file: Path, field: str) -> bytes:
    with open_file(file, field, LARGEST_TEXT_BYTES) as stream:
        return stream.read(LARGEST_TEXT_BYTES)


def _context(tls: Tls) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(tls.certificate, tls.key)
    except (OSError, ssl.SSLError) as error:
        raise _unfit(tls, error) from None
    return context


def _unfit(tls: Tls, error: Exception) -> InvalidValue:
    expected = f"a certificate with its key, both in PEM ({error})"
    return InvalidValue("console_certificate", str(tls.certificate), expected)
