"""A keystore: one authority, and the enclaves that it lets in; in folders as sros2 has them.

What an enclave was made for, kept beside it: what `renew` makes its permissions of again.
"""

import json
import os
import re
import shutil
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.serialization import Encoding
from cryptography.hazmat.primitives.serialization.pkcs7 import PKCS7Options, PKCS7SignatureBuilder
from pydantic import TypeAdapter

from edgevox.core.certificates import (
    BACK,
    LONGEST_NAME,
    Identity,
    make_authority,
    make_identity,
    read_certificate,
    read_identity,
    signer_of,
)
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.state_files import PRIVATE, PUBLIC, write_atomically
from edgevox.core.files.user_file import read_text
from edgevox.security.documents import governance, permissions
from edgevox.security.roles import EnclaveRole, Graph, rights_of


@dataclass(frozen=True, slots=True)
class Purpose:
    """A role with a robot, on one domain, for so many days each time."""

    role: EnclaveRole
    graph: Graph
    domain: int
    days: int

    def lasting(self, days: int) -> "Purpose":
        """The same for so many days."""
        return replace(self, days=days)

    def written(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self), default=str, indent=2) + "\n"

    @classmethod
    def read(cls, text: str) -> "Purpose":
        """From what was `written`. Raises `ValueError` for what was not."""
        return TypeAdapter(cls).validate_json(text)


AUTHORITY_DAYS, DAYS = 3650, 365
PRIVATE_FOLDER = 0o700
_ENCLAVE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_CERTIFICATE, _KEY = "cert.pem", "key.pem"
_PURPOSE = "edgevox.json"
_CRL = "crl.pem"
_CA_CERTIFICATES = ("identity_ca.cert.pem", "permissions_ca.cert.pem")
OF_AN_ENCLAVE = (
    _CERTIFICATE,
    _KEY,
    "permissions.p7s",
    "governance.p7s",
    *_CA_CERTIFICATES,
    _CRL,
)
"""What a participant reads."""


class Keystore:
    """The keystore in a folder. Raises `InvalidValue` naming KEYSTORE where there is none."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.enclaves = folder / "enclaves"
        self._public, self._private = folder / "public", folder / "private"
        if not (self._private / "ca.key.pem").is_file() or not self.enclaves.is_dir():
            raise InvalidValue("KEYSTORE", str(folder), "a folder that `create` made")
        certificate, key = self._public / "ca.cert.pem", self._private / "ca.key.pem"
        self._authority = read_identity(_read(certificate), _read(key), str(folder))

    @classmethod
    def create(cls, folder: Path, now: datetime, days: int = AUTHORITY_DAYS) -> "Keystore":
        """Make one, in a folder that is not there yet, or empty."""
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise InvalidValue("KEYSTORE", str(folder), "a folder that is not there yet, or empty")
        authority = make_authority("edgevox", now, days)
        for one in (folder, folder / "public", folder / "private", folder / "enclaves"):
            one.mkdir(mode=PRIVATE_FOLDER, parents=one == folder, exist_ok=True)
        folder.chmod(PRIVATE_FOLDER)
        _write_authority(folder, authority)
        _write_signed(folder / "enclaves" / "governance", governance(), authority)
        _write_list(folder / "public", authority, (), now)
        return cls(folder)

    @property
    def authority(self) -> x509.Certificate:
        """Whose signatures count."""
        return self._authority.certificate

    def names(self) -> Sequence[str]:
        """The enclaves that are there."""
        found = self.enclaves.rglob(_CERTIFICATE)
        return sorted(f"/{one.parent.relative_to(self.enclaves)}" for one in found)

    def certificate(self, enclave: str) -> x509.Certificate:
        """Who the enclave is, and until when."""
        file = self.at(enclave) / _CERTIFICATE
        return read_certificate(_read(file), str(file))

    def purpose(self, enclave: str) -> Purpose:
        """What the enclave is for. Raises `InvalidValue` for one that another tool made."""
        file = self.at(enclave) / _PURPOSE
        if not file.is_file():
            raise InvalidValue("ENCLAVE", enclave, "one that edgevox-security added")
        text = read_text(file, _PURPOSE)
        try:
            return Purpose.read(text)
        except ValueError:
            raise InvalidValue(_PURPOSE, str(file), "what edgevox-security wrote there") from None

    def at(self, enclave: str) -> Path:
        """The folder of an enclave that is there."""
        folder = self.enclaves / enclave.lstrip("/")
        if not _ENCLAVE.fullmatch(enclave) or not (folder / _CERTIFICATE).is_file():
            known = ", ".join(self.names()) or "no enclave, since none was added"
            raise InvalidValue("ENCLAVE", enclave, f"one of: {known}")
        return folder

    def add(self, enclave: str, purpose: Purpose, now: datetime) -> None:
        """Let one more in. Raises `InvalidValue` where the enclave is there already."""
        if not _ENCLAVE.fullmatch(enclave) or len(enclave) > LONGEST_NAME:
            expected = f"a path such as /robot1/laptop, of {LONGEST_NAME} characters at most"
            raise InvalidValue("--enclave", enclave, expected)
        folder = self.enclaves / enclave.lstrip("/")
        if (folder / _CERTIFICATE).exists():
            raise InvalidValue("--enclave", enclave, "one that is not there yet; `renew` renews it")
        rights_of(purpose.role, purpose.graph, enclave)  # what is wrong with it is said before
        for one in reversed([folder, *folder.parents[: enclave.count("/") - 1]]):
            one.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
        for name in _CA_CERTIFICATES:
            _link(folder / name, self._public / name)
        _link(folder / "governance.p7s", self.enclaves / "governance.p7s")
        _link(folder / _CRL, self._public / _CRL)
        self._issue(enclave, purpose, now)

    def renew(self, enclave: str, now: datetime, days: int | None = None) -> None:
        """Give an enclave another key, certificate and permissions, as the contract now is."""
        purpose = self.purpose(enclave)
        self._issue(enclave, purpose.lasting(days) if days else purpose, now)

    def revoke(self, enclave: str, now: datetime) -> None:
        """Take an enclave away, and put its certificate on the list of those that do not count."""
        folder = self.at(enclave)
        crl = self._public / _CRL
        serials = _revoked_serials(_read(crl), str(crl))
        serials.add(self.certificate(enclave).serial_number)
        _write_list(self._public, self._authority, serials, now)
        for file in folder.iterdir():
            if file.is_file():
                file.unlink()
        with suppress(OSError):  # others are below it
            folder.rmdir()

    def export(self, enclave: str) -> dict[str, bytes]:
        """What a participant needs of it, by the files' names; nothing of the authority's key."""
        folder = self.at(enclave)
        for name in OF_AN_ENCLAVE:
            if not (folder / name).exists():
                raise EdgeVoxError(f"{folder / name}: missing, expected of every enclave")
        return {name: _read(folder / name).encode() for name in OF_AN_ENCLAVE}

    def _issue(self, enclave: str, purpose: Purpose, now: datetime) -> None:
        rights = rights_of(purpose.role, purpose.graph, enclave)
        made = make_identity(self._authority, enclave, now, self._lasting(purpose.days, now))
        begins, ends = made.certificate.not_valid_before_utc, made.certificate.not_valid_after_utc
        folder = self.enclaves / enclave.lstrip("/")
        text = permissions(enclave, purpose.domain, begins, ends, rights)
        _write_signed(folder / "permissions", text, self._authority)
        write_atomically(folder / _PURPOSE, purpose.written(), PUBLIC)
        write_atomically(folder / _KEY, made.key_pem, PRIVATE)
        write_atomically(folder / _CERTIFICATE, made.certificate_pem, PUBLIC)

    def _lasting(self, days: int, now: datetime) -> int:
        """So many days, or those that the authority has left. Raises `EdgeVoxError` for none."""
        ends = self.authority.not_valid_after_utc
        if ends <= now:
            raise EdgeVoxError(f"authority: it ended {ends:%Y-%m-%d}, expected another keystore")
        return min(days, (ends - now).days)


def _read(file: Path) -> str:
    return read_text(file, file.name)


def _write_authority(folder: Path, authority: Identity) -> None:
    files = {
        folder / "private" / "ca.key.pem": (authority.key_pem, PRIVATE),
        folder / "public" / "ca.cert.pem": (authority.certificate_pem, PUBLIC),
    }
    for file, (text, mode) in files.items():
        write_atomically(file, text, mode)
        for use in ("identity", "permissions"):
            _link(file.with_name(f"{use}_{file.name}"), file)


def _write_list(
    public: Path, authority: Identity, serials: Sequence[int] | set[int], now: datetime
) -> None:
    """Which of the authority's certificates count no more.

    The list says itself valid for as long as the authority: one that had ended would let nobody in.
    """
    signer = authority.certificate
    builder = x509.CertificateRevocationListBuilder().issuer_name(signer.subject)
    builder = builder.last_update(now - BACK).next_update(signer.not_valid_after_utc)
    for serial in sorted(serials):
        revoked = x509.RevokedCertificateBuilder().serial_number(serial).revocation_date(now)
        builder = builder.add_revoked_certificate(revoked.build())
    builder = builder.add_extension(signer_of(authority), critical=False)
    builder = builder.add_extension(x509.CRLNumber(int(now.timestamp())), critical=False)
    text = builder.sign(authority.key, hashes.SHA256()).public_bytes(Encoding.PEM).decode()
    write_atomically(public / _CRL, text, PUBLIC)


def _revoked_serials(pem: str, name: str) -> set[int]:
    """The serial numbers on a list in PEM. Raises `EdgeVoxError`, naming the file."""
    try:
        return {one.serial_number for one in x509.load_pem_x509_crl(pem.encode())}
    except ValueError:
        raise EdgeVoxError(f"{name}: no list of revoked certificates in PEM") from None


def _write_signed(path: Path, text: str, authority: Identity) -> None:
    """The document, and beside it as S/MIME with its signature, which DDS security reads."""
    builder = PKCS7SignatureBuilder().set_data(text.encode())
    builder = builder.add_signer(authority.certificate, authority.key, hashes.SHA256())
    options = [PKCS7Options.Text, PKCS7Options.DetachedSignature]
    signed = builder.sign(Encoding.SMIME, options).decode()
    write_atomically(path.with_suffix(".xml"), text, PUBLIC)
    write_atomically(path.with_suffix(".p7s"), signed, PUBLIC)


def _link(link: Path, to: Path) -> None:
    link.unlink(missing_ok=True)
    link.symlink_to(os.path.relpath(to, link.parent))


def write_export(files: dict[str, bytes], enclave: str, folder: Path) -> None:
    """A keystore with this enclave only, in a folder that is not there yet, or empty."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InvalidValue("DIR", str(folder), "a folder that is not there yet, or empty")
    inside = folder / "enclaves" / enclave.lstrip("/")
    inside.mkdir(parents=True)
    for one in (folder, *(each for each in folder.rglob("*") if each.is_dir())):
        one.chmod(PRIVATE_FOLDER)
    try:
        for name, data in files.items():
            write_atomically(inside / name, data.decode(), PRIVATE if name == _KEY else PUBLIC)
    except OSError:
        shutil.rmtree(folder)
        raise
