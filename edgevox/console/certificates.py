"""The console's encryption: its files, and the robot's own authority that gives it a certificate.

The authority is made once and lies on the robot's volume; people take its certificate, without its
key, into their browsers. It may vouch for local names and private addresses only, and for names
that it was made with: whoever steals its key cannot pretend to be somebody's bank.
"""

import hashlib
import socket
import ssl
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from ipaddress import IPv4Address, IPv6Address, ip_address, ip_network
from pathlib import Path

from cryptography import x509
from cryptography.x509.oid import ExtendedKeyUsageOID

from edgevox.core.certificates import (
    LONGEST_NAME,
    Identity,
    make_authority,
    make_identity,
    read_certificate,
    read_identity,
    read_key,
    utc_now,
)
from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import PRIVATE, PUBLIC, StateFiles, write_atomically
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, open_file, read_text

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


FOLDER = "console_folder"
AUTHORITY_DAYS = 3650
DAYS = 390
"""Browsers take no certificate that lasts longer than 398."""
RENEW_DAYS = 30
"""Days before its end when a certificate is renewed, at the start and while the console runs."""
_LOCAL = ("local", "localhost", "lan", "internal", "home.arpa")
_PRIVATE = tuple(
    map(
        ip_network,
        ("10.0.0.0/8", "172.16.0.0/12", "192.168.0.0/16", "169.254.0.0/16", "127.0.0.0/8",
         "::1/128", "fc00::/7", "fe80::/10"),
    )
)  # fmt: skip
Now = Callable[[], datetime]
Address = IPv4Address | IPv6Address


def own_tls(
    folder: Path,
    names: Sequence[str],
    now: Now = utc_now,
    state: StateFiles | None = None,
    *,
    spare: Collection[str] = (),
) -> Tls:
    """Authority and certificate for these names and addresses, made where they are not there yet.

    Files that cannot be used are kept aside, and others are made. The result's `renew` makes the
    certificate again where it ends soon by then; it never makes another authority. Of names that
    are `spare` the certificate has those for which the authority may vouch: a machine may be called
    otherwise by now, as a container is at each start.
    Raises `InvalidValue` for a name that the authority may not vouch for, and `OSError`.
    """
    state = state or StateFiles()
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    authority = _kept(state, folder / "ca.crt", folder / "ca.key", x509.NameConstraints)
    if not authority:
        for file in (folder / "ca.crt", folder / "ca.key"):
            state.keep_aside(file, f"{file}: expected a certificate and a key that fit")
        authority = _make_authority(names, now())
        _write(authority, folder / "ca.crt", folder / "ca.key")
    names = [name for name in names if name not in spare or _vouches(authority.certificate, name)]
    _check(authority.certificate, names)
    certificate, key = folder / "console.crt", folder / "console.key"
    leaf = _kept(state, certificate, key, x509.SubjectAlternativeName)
    if not leaf or not _fits(leaf.certificate, authority.certificate, names, now()):
        leaf = _make_leaf(authority, names, now())
        certificate.unlink(missing_ok=True)  # never a certificate with another's key
        _write(leaf, certificate, key)

    def renew() -> None:
        certificate, key = (read_text(folder / name, FOLDER) for name in ("ca.crt", "ca.key"))
        _needs(x509.NameConstraints, read_identity(certificate, key, FOLDER).certificate)
        own_tls(folder, names, now, state, spare=spare)

    return Tls(certificate, key, folder / "ca.crt", renew)


def local_names(more: Sequence[str] = ()) -> tuple[str, ...]:
    """Return this machine's local names: host names, `more`, and its addresses."""
    host = socket.gethostname().split(".")[0].lower()
    hosts = (host, f"{host}.local") if _is_name(host) else ()
    found = ("localhost", *hosts, *more, "127.0.0.1", "::1", *own_addresses())
    return tuple(dict.fromkeys(found))


def own_addresses() -> list[str]:
    """The private addresses by which this machine would send."""
    found = []
    for family, there in ((socket.AF_INET, "192.0.2.1"), (socket.AF_INET6, "2001:db8::1")):
        with socket.socket(family, socket.SOCK_DGRAM) as one:
            try:
                one.connect((there, 9))  # sends nothing
            except OSError:
                continue
            found.append(one.getsockname()[0])
    return [one for one in found if is_private_address(ip_address(one))]


def _is_name(host: str) -> bool:
    try:
        x509.DNSName(host)
    except ValueError:
        return False
    return bool(host)


def is_private_address(address: Address) -> bool:
    """Return whether only a local network reaches this address."""
    return any(address in network for network in _PRIVATE)


def _general(name: str) -> x509.DNSName | x509.IPAddress:
    try:
        return x509.IPAddress(ip_address(name))
    except ValueError:
        pass
    try:
        return x509.DNSName(name)
    except ValueError:
        raise InvalidValue("console_names", name, "host names and addresses") from None


def _kept(
    state: StateFiles, certificate: Path, key: Path, needs: type[x509.ExtensionType]
) -> Identity | None:
    """The identity in these files, if both are there and fit; it needs this extension."""
    made = state.read(certificate, lambda text: _needs(needs, read_certificate(text, FOLDER)))
    own = state.read(key, lambda text: read_key(text, FOLDER), secret=True)
    fits = made and own and made.public_key() == own.public_key()
    return Identity(made, own) if made and own and fits else None


def _needs(extension: type[x509.ExtensionType], made: x509.Certificate) -> x509.Certificate:
    try:
        made.extensions.get_extension_for_class(extension)
    except x509.ExtensionNotFound:
        raise InvalidValue(FOLDER, "another certificate", "one that EdgeVox made") from None
    return made


def _write(identity: Identity, certificate: Path, key: Path) -> None:
    write_atomically(key, identity.key_pem, PRIVATE)
    write_atomically(certificate, identity.certificate_pem, PUBLIC)


def _make_authority(names: Sequence[str], now: datetime) -> Identity:
    called = f"EdgeVox of {socket.gethostname()}"[:LONGEST_NAME]
    return make_authority(called, now, AUTHORITY_DAYS, [(_constraints(names), True)])


def _constraints(names: Sequence[str]) -> x509.NameConstraints:
    general = [_general(name) for name in names]
    hosts = [one.value for one in general if isinstance(one, x509.DNSName)]
    extra = [ip_network(one.value) for one in general if isinstance(one, x509.IPAddress)]
    return x509.NameConstraints(
        permitted_subtrees=[
            *(x509.DNSName(host) for host in dict.fromkeys((*_LOCAL, *hosts))),
            *(x509.IPAddress(one) for one in dict.fromkeys((*_PRIVATE, *extra))),
        ],
        excluded_subtrees=None,
    )


def _make_leaf(authority: Identity, names: Sequence[str], now: datetime) -> Identity:
    server = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH])
    known_as = x509.SubjectAlternativeName([_general(name) for name in names])
    more = [(server, False), (known_as, False)]
    return make_identity(authority, "EdgeVox console", now, DAYS, more)


def _check(authority: x509.Certificate, names: Sequence[str]) -> None:
    for name in names:
        if not _vouches(authority, name):
            raise InvalidValue(
                "console_names",
                name,
                "a name that the own authority was made for; `edgevox-console ca --new` makes "
                "another one, which each browser has to take",
            )


def _vouches(authority: x509.Certificate, name: str) -> bool:
    found = authority.extensions.get_extension_for_class(x509.NameConstraints).value
    return any(_permits(one, _general(name)) for one in found.permitted_subtrees or [])


def _permits(subtree: x509.GeneralName, name: x509.DNSName | x509.IPAddress) -> bool:
    if isinstance(subtree, x509.IPAddress) and isinstance(name, x509.IPAddress):
        address, network = name.value, subtree.value
        return isinstance(address, Address) and address in network  # type: ignore[operator]
    if isinstance(subtree, x509.DNSName) and isinstance(name, x509.DNSName):
        return name.value == subtree.value or name.value.endswith("." + subtree.value)
    return False


def _fits(
    leaf: x509.Certificate, authority: x509.Certificate, names: Sequence[str], now: datetime
) -> bool:
    """Return whether the certificate is this authority's, for these names, and in time."""
    known_as = leaf.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    try:
        leaf.verify_directly_issued_by(authority)
    except Exception:  # noqa: BLE001 - of whatever kind: another authority's
        return False
    lasts = leaf.not_valid_after_utc - now > timedelta(days=RENEW_DAYS)
    return lasts and set(known_as) == {_general(name) for name in names}
