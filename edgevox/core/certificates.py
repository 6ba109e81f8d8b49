"""Certificates: an authority that signs itself, and identities that it signs. Needs cryptography.

The console's TLS and ROS 2's enclaves are made of these.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from cryptography import x509
from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_pem_private_key,
)
from cryptography.x509.oid import NameOID

from edgevox.core.errors import InvalidValue

LONGEST_NAME = 64
"""Characters of a common name (X.520)."""
BACK = timedelta(days=1)
"""Certificates begin before they are made: the clock of a robot without a battery is behind."""

Extension = tuple[x509.ExtensionType, bool]
"""An extension, and whether it is critical."""


@dataclass(frozen=True)
class Identity:
    """A certificate and its private key."""

    certificate: x509.Certificate
    key: ec.EllipticCurvePrivateKey

    @property
    def certificate_pem(self) -> str:
        return self.certificate.public_bytes(Encoding.PEM).decode()

    @property
    def key_pem(self) -> str:
        form = PrivateFormat.PKCS8
        return self.key.private_bytes(Encoding.PEM, form, NoEncryption()).decode()


def make_authority(name: str, now: datetime, days: int, more: Sequence[Extension] = ()) -> Identity:
    """An authority that signs itself. It may sign certificates of ends only, not of authorities."""
    key = ec.generate_private_key(ec.SECP256R1())
    own = x509.SubjectKeyIdentifier.from_public_key(key.public_key())
    given = [(own, False), *_uses(authority=True), *more]
    return _signed(name, _name(name), key, (now, days), given, signs=key)


def make_identity(
    authority: Identity, name: str, now: datetime, days: int, more: Sequence[Extension] = ()
) -> Identity:
    """An identity by this name that the authority vouches for."""
    key = ec.generate_private_key(ec.SECP256R1())
    given = [(signer_of(authority), False), *_uses(authority=False), *more]
    issuer = authority.certificate.subject
    return _signed(name, issuer, key, (now, days), given, signs=authority.key)


def signer_of(authority: Identity) -> x509.AuthorityKeyIdentifier:
    """The extension that tells whose signature it is."""
    return x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key())


def read_certificate(pem: str, field: str) -> x509.Certificate:
    """Raises `InvalidValue` for this field, without the text."""
    try:
        return x509.load_pem_x509_certificate(pem.encode())
    except ValueError:
        raise InvalidValue(field, "a text", "a certificate in PEM") from None


def read_key(pem: str, field: str) -> ec.EllipticCurvePrivateKey:
    """Raises `InvalidValue` for this field, without the text."""
    try:
        key = load_pem_private_key(pem.encode(), None)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise InvalidValue(field, "a text", "a private key in PEM") from None
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise InvalidValue(field, "another key", "a key on an elliptic curve")
    return key


def read_identity(certificate: str, key: str, field: str) -> Identity:
    """Both from PEM. Raises `InvalidValue` for this field, also where they are not a pair."""
    made = Identity(read_certificate(certificate, field), read_key(key, field))
    if made.key.public_key() != made.certificate.public_key():
        raise InvalidValue(field, "another certificate's key", "this certificate's")
    return made


def utc_now() -> datetime:
    """The time by the system's clock, in whole seconds."""
    return datetime.now(UTC).replace(microsecond=0)


def _name(common: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common)])


def _signed(
    name: str,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    period: tuple[datetime, int],
    extensions: Sequence[Extension],
    *,
    signs: ec.EllipticCurvePrivateKey,
) -> Identity:
    now, days = period
    builder = (
        x509.CertificateBuilder()
        .subject_name(_name(name))
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - BACK)
        .not_valid_after(now + timedelta(days=days))
    )
    for extension, critical in extensions:
        builder = builder.add_extension(extension, critical=critical)
    return Identity(builder.sign(signs, hashes.SHA256()), key)


def _uses(*, authority: bool) -> list[Extension]:
    """What it may be used for: OpenSSL is strict about that."""
    usage = x509.KeyUsage(
        digital_signature=True,  # of an authority, those of an enclave's documents
        key_cert_sign=authority,
        crl_sign=authority,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )
    length = 0 if authority else None
    return [(x509.BasicConstraints(ca=authority, path_length=length), True), (usage, True)]
