"""The robot's own certificate authority, and the certificate that it gives its console.

The authority is made once and lies on the robot's volume; people take its certificate, without its
key, into their browsers. It may vouch for local names and private addresses only, and for names
that it was made with: whoever steals its key cannot pretend to be somebody's bank.
"""

import socket
from collections.abc import Callable, Collection, Sequence
from datetime import UTC, datetime, timedelta
from ipaddress import IPv4Address, IPv6Address, ip_address, ip_network
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from edgevox.console.tls import Tls
from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import PRIVATE, PUBLIC, StateFiles, write_atomically
from edgevox.core.files.user_file import read_text

AUTHORITY_DAYS = 3650
DAYS = 390
"""Browsers take no certificate that lasts longer than 398."""
RENEW_DAYS = 30
"""Days before its end when a certificate is renewed, at the start and while the console runs."""
_BACK = timedelta(days=1)
"""Clocks of phones are behind that of a robot without a battery, or ahead."""
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


def utc_now() -> datetime:
    """The time by the system's clock."""
    return datetime.now(UTC)


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
    authority = state.read(folder / "ca.crt", _authority)
    signs = state.read(folder / "ca.key", _key, secret=True)
    if not authority or not signs or authority.public_key() != signs.public_key():
        for file in (folder / "ca.crt", folder / "ca.key"):
            state.keep_aside(file, f"{file}: expected a certificate and a key that fit")
        authority, signs = _make_authority(folder, names, now())
    names = [name for name in names if name not in spare or _vouches(authority, name)]
    _check(authority, names)
    certificate, key = folder / "console.crt", folder / "console.key"
    leaf, own = state.read(certificate, _leaf), state.read(key, _key, secret=True)
    if not leaf or not own or not _fits(leaf, own, authority, names, now()):
        _make_leaf((authority, signs), certificate, key, names, now())

    def renew() -> None:
        _authority(read_text(folder / "ca.crt", "console_folder"))
        _key(read_text(folder / "ca.key", "console_folder"))
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


def _make_authority(
    folder: Path, names: Sequence[str], now: datetime
) -> tuple[x509.Certificate, ec.EllipticCurvePrivateKey]:
    private = ec.generate_private_key(ec.SECP256R1())
    called = x509.Name(
        [x509.NameAttribute(NameOID.COMMON_NAME, f"EdgeVox of {socket.gethostname()}"[:64])]
    )
    public = private.public_key()
    made = (
        _builder(called, called, public, now, AUTHORITY_DAYS)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(_usage(authority=True), critical=True)
        .add_extension(_constraints(names), critical=True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(public), critical=False)
        .sign(private, hashes.SHA256())
    )
    _write_key(folder / "ca.key", private)
    _write_certificate(folder / "ca.crt", made)
    return made, private


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


def _make_leaf(
    authority: tuple[x509.Certificate, ec.EllipticCurvePrivateKey],
    certificate: Path,
    key: Path,
    names: Sequence[str],
    now: datetime,
) -> None:
    issuer, signs = authority
    private = ec.generate_private_key(ec.SECP256R1())
    called = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "EdgeVox console")])
    server = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH])
    known_as = x509.SubjectAlternativeName([_general(name) for name in names])
    signer = x509.AuthorityKeyIdentifier.from_issuer_public_key(signs.public_key())
    made = (
        _builder(called, issuer.subject, private.public_key(), now, DAYS)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_usage(authority=False), critical=True)
        .add_extension(server, critical=False)
        .add_extension(known_as, critical=False)
        .add_extension(signer, critical=False)
        .sign(signs, hashes.SHA256())
    )
    certificate.unlink(missing_ok=True)  # never a certificate with another's key
    _write_key(key, private)
    _write_certificate(certificate, made)


def _builder(
    subject: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePublicKey, now: datetime, days: int
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _BACK)
        .not_valid_after(now + timedelta(days=days))
    )


def _usage(*, authority: bool) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=not authority,
        key_cert_sign=authority,
        crl_sign=authority,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )


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
    leaf: x509.Certificate,
    key: ec.EllipticCurvePrivateKey,
    authority: x509.Certificate,
    names: Sequence[str],
    now: datetime,
) -> bool:
    """Return whether the certificate is this authority's, for these names, and in time."""
    known_as = leaf.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    try:
        leaf.verify_directly_issued_by(authority)
    except Exception:  # noqa: BLE001 - of whatever kind: another authority's
        return False
    lasts = leaf.not_valid_after_utc - now > timedelta(days=RENEW_DAYS)
    own = leaf.public_key() == key.public_key()
    return own and lasts and set(known_as) == {_general(name) for name in names}


def _authority(text: str) -> x509.Certificate:
    """The certificate of an own authority. Raises whatever is wrong with the text."""
    made = _load(text)
    made.extensions.get_extension_for_class(x509.NameConstraints)
    return made


def _leaf(text: str) -> x509.Certificate:
    """The console's certificate. Raises whatever is wrong with the text."""
    made = _load(text)
    made.extensions.get_extension_for_class(x509.SubjectAlternativeName)
    return made


def _load(text: str) -> x509.Certificate:
    try:
        return x509.load_pem_x509_certificate(text.encode())
    except ValueError:
        raise InvalidValue("console_folder", "a text", "a certificate in PEM") from None


def _key(text: str) -> ec.EllipticCurvePrivateKey:
    """A key of ours. Its text stands in no error."""
    try:
        key = serialization.load_pem_private_key(text.encode(), None)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise InvalidValue("console_folder", "a text", "a private key in PEM") from None
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise InvalidValue("console_folder", "another key", "a key on an elliptic curve")
    return key


def _write_key(file: Path, key: ec.EllipticCurvePrivateKey) -> None:
    text = key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    write_atomically(file, text.decode(), PRIVATE)


def _write_certificate(file: Path, certificate: x509.Certificate) -> None:
    text = certificate.public_bytes(serialization.Encoding.PEM).decode()
    write_atomically(file, text, PUBLIC)
