"""A keystore's certificate authority, what it signs, and its list of what counts no more."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_pem_private_key,
)
from cryptography.hazmat.primitives.serialization.pkcs7 import (
    PKCS7Options,
    PKCS7SignatureBuilder,
)
from cryptography.x509.oid import NameOID

from edgevox.core.errors import EdgeVoxError

LONGEST_NAME = 64
"""Characters of a common name (X.520)."""
_BACK = timedelta(days=1)
"""The clock of a robot without a battery is behind."""


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


def make_authority(name: str, now: datetime, days: int) -> Identity:
    """One that signs itself, and may sign certificates of participants only."""
    key = ec.generate_private_key(ec.SECP256R1())
    called = _name(name)
    public = x509.SubjectKeyIdentifier.from_public_key(key.public_key())
    builder = _builder(called, called, key, now, days).add_extension(public, critical=False)
    return Identity(_extended(builder, authority=True).sign(key, hashes.SHA256()), key)


def make_identity(authority: Identity, enclave: str, now: datetime, days: int) -> Identity:
    """A participant's, by the name of its enclave; it ends no later than the authority.

    Raises `EdgeVoxError` where that has ended.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    signer = authority.certificate
    if signer.not_valid_after_utc <= now:
        ended = f"{signer.not_valid_after_utc:%Y-%m-%d}"
        raise EdgeVoxError(f"authority: it ended {ended}, expected a keystore made anew")
    issuer = x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key())
    left_days = (signer.not_valid_after_utc - now).days
    builder = _builder(_name(enclave), signer.subject, key, now, min(days, left_days))
    builder = _extended(builder.add_extension(issuer, critical=False), authority=False)
    return Identity(builder.sign(authority.key, hashes.SHA256()), key)


def read_certificate(data: bytes, name: str) -> x509.Certificate:
    """From PEM. Raises `EdgeVoxError`, naming the file, where it is none."""
    try:
        return x509.load_pem_x509_certificate(data)
    except ValueError:
        raise EdgeVoxError(f"{name}: no certificate in PEM") from None


def read_identity(certificate: bytes, key: bytes) -> Identity:
    """Both from PEM. Raises `EdgeVoxError` where they are no such thing, or not one another's."""
    try:
        read = x509.load_pem_x509_certificate(certificate)
        private = load_pem_private_key(key, None)
    except (ValueError, TypeError) as error:
        raise EdgeVoxError(f"certificate and key: {error}") from None
    if not isinstance(private, ec.EllipticCurvePrivateKey):
        raise EdgeVoxError("key: got another kind, expected one on an elliptic curve")
    if private.public_key() != read.public_key():
        raise EdgeVoxError("key: got another certificate's, expected this one's")
    return Identity(read, private)


def signed(authority: Identity, document: str) -> str:
    """The document as S/MIME with the authority's signature, which DDS security reads."""
    builder = PKCS7SignatureBuilder().set_data(document.encode())
    builder = builder.add_signer(authority.certificate, authority.key, hashes.SHA256())
    options = [PKCS7Options.Text, PKCS7Options.DetachedSignature]
    return builder.sign(Encoding.SMIME, options).decode()


def revocation_list(authority: Identity, serials: Iterable[int], now: datetime) -> str:
    """Which of the authority's certificates count no more.

    It says itself valid for as long as the authority: one that had ended would let nobody in.
    """
    signer = authority.certificate
    builder = x509.CertificateRevocationListBuilder().issuer_name(signer.subject)
    builder = builder.last_update(now - _BACK).next_update(signer.not_valid_after_utc)
    for serial in sorted(serials):
        revoked = x509.RevokedCertificateBuilder().serial_number(serial).revocation_date(now)
        builder = builder.add_revoked_certificate(revoked.build())
    issuer = x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key())
    builder = builder.add_extension(issuer, critical=False)
    builder = builder.add_extension(x509.CRLNumber(int(now.timestamp())), critical=False)
    return builder.sign(authority.key, hashes.SHA256()).public_bytes(Encoding.PEM).decode()


def revoked_serials(data: bytes, name: str) -> set[int]:
    """The serial numbers on a list in PEM. Raises `EdgeVoxError`, naming the file."""
    try:
        return {one.serial_number for one in x509.load_pem_x509_crl(data)}
    except ValueError:
        raise EdgeVoxError(f"{name}: no list of revoked certificates in PEM") from None


def utc_now() -> datetime:
    """The time by the system's clock, in whole seconds."""
    return datetime.now(UTC).replace(microsecond=0)


def _name(common: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common)])


def _builder(
    subject: x509.Name,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    now: datetime,
    days: int,
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _BACK)
        .not_valid_after(now + timedelta(days=days))
    )


def _extended(builder: x509.CertificateBuilder, *, authority: bool) -> x509.CertificateBuilder:
    """What it may be used for: OpenSSL is asked to be strict about that."""
    length = 0 if authority else None
    usage = x509.KeyUsage(
        digital_signature=True,  # of an authority, those of the two documents
        key_cert_sign=authority,
        crl_sign=authority,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )
    constraints = x509.BasicConstraints(ca=authority, path_length=length)
    return builder.add_extension(constraints, critical=True).add_extension(usage, critical=True)
