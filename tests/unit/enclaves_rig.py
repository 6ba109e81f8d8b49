"""Enclaves as sros2 lays them out, with certificates that end when a test says."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import NameOID

NOW = datetime.now(UTC).replace(microsecond=0)
DAY = timedelta(days=1)
YEAR = 365 * DAY
PERMISSIONS = """MIME-Version: 1.0
Content-Type: multipart/signed; protocol="application/x-pkcs7-signature"; boundary="----1"

------1
Content-Type: text/plain

<validity><not_before>{begins:%Y-%m-%dT%H:%M:%S}</not_before>
<not_after>{ends:%Y-%m-%dT%H:%M:%S}</not_after></validity>
<allow_rule>
  <domains>{domains}</domains>
</allow_rule>
------1
"""


def certificate(begins: datetime, ends: datetime) -> tuple[str, str]:
    """A certificate and its key, in PEM."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "/robot1/edgevox")])
    builder = x509.CertificateBuilder().subject_name(name).issuer_name(name)
    builder = builder.public_key(key.public_key()).serial_number(x509.random_serial_number())
    made = builder.not_valid_before(begins).not_valid_after(ends).sign(key, hashes.SHA256())
    form = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    return made.public_bytes(Encoding.PEM).decode(), form.decode()


def make_enclave(
    keystore: Path,
    enclave: str = "/robot1/edgevox",
    begins: datetime = NOW - DAY,
    ends: datetime = NOW + YEAR,
    authority_ends: datetime = NOW + 10 * YEAR,
    domains: str = "<id>0</id>",
) -> Path:
    """The folder of an enclave that is made, on these domains."""
    folder = keystore / "enclaves" / enclave.lstrip("/")
    folder.mkdir(parents=True)
    own, key = certificate(begins, ends)
    authority, _ = certificate(begins, authority_ends)
    for name, text in {
        "cert.pem": own,
        "key.pem": key,
        "identity_ca.cert.pem": authority,
        "permissions_ca.cert.pem": authority,
        "permissions.p7s": PERMISSIONS.format(begins=begins, ends=ends, domains=domains),
        "governance.p7s": "signed",
    }.items():
        (folder / name).write_text(text)
    (folder / "key.pem").chmod(0o600)
    return folder
