"""`edgevox-security`: what it writes, who can read it, and what it refuses."""

import base64
import json
import shutil
from datetime import UTC, datetime, timedelta
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml
from cryptography import x509
from cryptography.hazmat.primitives.serialization.pkcs7 import load_pem_pkcs7_certificates

from edgevox.apps.security_command import main
from edgevox.security.keystore import OF_AN_ENCLAVE, Keystore, Purpose
from edgevox.security.roles import EnclaveRole, Graph

LISTENER = "/edgevox/listener"
CAPSYS = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A keystore with every enclave, to take copies of: to sign all that takes a while."""
    folder = tmp_path_factory.mktemp("made") / "keystore"
    assert main(["create", str(folder)]) == 0
    for role in EnclaveRole:
        assert main(["add", str(folder), role, "--domain", "7"]) == 0
    return folder


@pytest.fixture
def store(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "keystore", symlinks=True))


def text_of(folder: Path) -> str:
    """Every file of a folder, one after another."""
    return "".join(one.read_text("utf-8") for one in folder.rglob("*") if one.is_file())


def test_a_keystore_is_as_sros2_has_it(store: Path) -> None:
    assert {one.name for one in (store / "private").iterdir()} == {
        "ca.key.pem",
        "identity_ca.key.pem",
        "permissions_ca.key.pem",
    }
    assert {"ca.cert.pem", "identity_ca.cert.pem", "permissions_ca.cert.pem"} <= {
        one.name for one in (store / "public").iterdir()
    }
    assert {one.name for one in (store / "enclaves").glob("governance.*")} == {
        "governance.xml",
        "governance.p7s",
    }
    files = {one.name for one in (store / "enclaves/edgevox/listener").iterdir()}
    assert files == {*OF_AN_ENCLAVE, "permissions.xml", "edgevox.json"}


def test_nobody_else_can_read_a_keystore(store: Path) -> None:
    assert {one.stat().st_mode & 0o777 for one in (store, *store.rglob("*")) if one.is_dir()} == {
        0o700
    }
    assert {one.stat().st_mode & 0o777 for one in store.rglob("*key.pem")} == {0o600}


def test_everything_is_encrypted_and_strangers_are_not_let_in(store: Path) -> None:
    rule = ET.parse(store / "enclaves/governance.xml").getroot()  # noqa: S314 - our own
    kinds = {one.tag: one.text for one in rule.iter() if one.tag.endswith("protection_kind")}
    assert len(kinds) == 5
    assert set(kinds.values()) == {"ENCRYPT"}
    assert rule.findtext(".//allow_unauthenticated_participants") == "false"
    enabled = [one.text for one in rule.iter() if one.tag.startswith("enable_")]
    assert enabled == ["true"] * 5


def test_permissions_are_for_the_certificates_name_on_one_domain_and_deny_the_rest(
    store: Path,
) -> None:
    grant = ET.parse(store / "enclaves/edgevox/listener/permissions.xml").getroot()  # noqa: S314
    certificate = Keystore(store).certificate(LISTENER)
    assert grant.findtext(".//subject_name") == certificate.subject.rfc4514_string()
    assert [one.text for one in grant.iter("id")] == ["7"]
    assert grant.findtext(".//default") == "DENY"
    ends = datetime.fromisoformat(grant.findtext(".//not_after") or "").replace(tzinfo=UTC)
    assert ends == certificate.not_valid_after_utc


def test_a_document_is_signed_as_it_stands(store: Path) -> None:
    folder = store / "enclaves/edgevox/listener"
    signed = (folder / "permissions.p7s").read_text("utf-8").replace("\r", "")
    assert (folder / "permissions.xml").read_text("utf-8") in signed
    encoded = signed.rpartition("\n\n")[0].rpartition("\n\n")[2]
    pem = f"-----BEGIN PKCS7-----\n{encoded}\n-----END PKCS7-----\n"
    assert load_pem_pkcs7_certificates(pem.encode()) == [Keystore(store).authority]


def test_list_names_everybody_and_warns_of_who_ends_soon(store: Path, capsys: CAPSYS) -> None:
    assert main(["list", str(store)]) == 0
    capsys.readouterr()
    assert main(["renew", str(store), LISTENER, "--days", "3"]) == 0
    assert main(["list", str(store)]) == 1
    told = capsys.readouterr()
    assert "/edgevox/edgevox_recorder" in told.out
    (line,) = [one for one in told.err.splitlines() if LISTENER in one]
    assert line.startswith(f"edgevox-security: {LISTENER}: ends in ")


def test_renewed_is_another_key_for_the_same(store: Path) -> None:
    folder = store / "enclaves/edgevox/listener"
    before = {name: (folder / name).read_bytes() for name in ("key.pem", "cert.pem")}
    purpose = json.loads((folder / "edgevox.json").read_text("utf-8"))
    assert main(["renew", str(store), "--all"]) == 0
    assert all((folder / name).read_bytes() != data for name, data in before.items())
    assert json.loads((folder / "edgevox.json").read_text("utf-8")) == purpose
    assert (folder / "key.pem").stat().st_mode & 0o777 == 0o600


def test_a_revoked_one_is_on_the_list_that_all_others_have(store: Path) -> None:
    serial = Keystore(store).certificate(LISTENER).serial_number
    assert main(["revoke", str(store), LISTENER]) == 0
    known = Keystore(store)
    assert LISTENER not in known.names()
    listed = x509.load_pem_x509_crl(known.export("/edgevox/edgevox")["crl.pem"])
    assert [one.serial_number for one in listed] == [serial]
    assert listed.next_update_utc == known.authority.not_valid_after_utc
    assert listed.is_signature_valid(known.authority.public_key())  # type: ignore[arg-type]
    assert main(["add", str(store), "listener"]) == 0


def test_an_export_is_a_keystore_of_one_without_links_and_without_the_authoritys_key(
    store: Path, tmp_path: Path
) -> None:
    to = tmp_path / "laptop"
    assert main(["export", str(store), LISTENER, str(to)]) == 0
    inside = to / "enclaves/edgevox/listener"
    assert {one.name for one in inside.iterdir()} == set(OF_AN_ENCLAVE)
    assert not [one for one in to.rglob("*") if one.is_symlink()]
    assert (store / "private/ca.key.pem").read_text("utf-8") not in text_of(to)
    assert text_of(to).count("PRIVATE KEY") == 2  # where one begins, and where it ends
    assert (inside / "key.pem").stat().st_mode & 0o777 == 0o600


def test_a_secret_has_the_same_files(store: Path, capsys: CAPSYS) -> None:
    capsys.readouterr()
    assert main(["export", str(store), LISTENER, "--kubernetes"]) == 0
    secret = yaml.safe_load(capsys.readouterr().out)
    assert secret["metadata"]["name"] == "edgevox-security-edgevox-listener"
    data = {name: base64.b64decode(text) for name, text in secret["data"].items()}
    assert data == Keystore(store).export(LISTENER)


def test_an_enclave_ends_no_later_than_the_authority(tmp_path: Path) -> None:
    now = datetime.now(UTC).replace(microsecond=0)
    made = Keystore.create(tmp_path / "short", now, days=10)
    made.add("/a", Purpose(EnclaveRole.ROBOT, Graph("/a", "robot-apartment"), 0, 365), now)
    assert made.certificate("/a").not_valid_after_utc <= now + timedelta(days=10)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["create", "{store}"], "KEYSTORE"),
        (["list", "{store}/nowhere"], "KEYSTORE"),
        (["add", "{store}", "listener"], "--enclave"),
        (["add", "{store}", "listener", "--enclave", "no slash"], "--enclave"),
        (["add", "{store}", "listener", "--enclave", "/../../out"], "--enclave"),
        (["add", "{store}", "listener", "--enclave", "/" + "a" * 64], "--enclave"),
        (["add", "{store}", "listener", "--namespace", "a b"], "agent_namespace"),
        (["add", "{store}", "robot", "--robot", "robot-unknown"], "--robot"),
        (["add", "{store}", "robot", "--robot-file", "x.yaml"], "--robot-file"),
        (["renew", "{store}"], "ENCLAVE"),
        (["renew", "{store}", "/nobody"], "ENCLAVE"),
        (["revoke", "{store}", "/nobody"], "ENCLAVE"),
        (["export", "{store}", "/../private", "{store}/out"], "ENCLAVE"),
        (["export", "{store}", LISTENER], "DIR"),
        (["export", "{store}", LISTENER, "{store}"], "DIR"),
        (["export", "{store}", LISTENER, "--kubernetes", "--name", "A B"], "--name"),
    ],
)
def test_what_makes_no_sense_is_one_line_that_names_it(
    store: Path, capsys: CAPSYS, arguments: list[str], named: str
) -> None:
    capsys.readouterr()
    before = text_of(store)
    assert main([one.format(store=store) for one in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"edgevox-security: {named}: got ")
    assert text_of(store) == before


@pytest.mark.parametrize("data", [b"garbage", b"", b"{}", b"[]", b"[" * 9999, b"\xff\xfe"])
@pytest.mark.parametrize(
    ("file", "commands"),
    [
        ("private/ca.key.pem", ["list"]),
        ("public/ca.cert.pem", ["list"]),
        ("public/crl.pem", ["revoke"]),
        ("enclaves/edgevox/listener/cert.pem", ["list", "revoke"]),
        ("enclaves/edgevox/listener/edgevox.json", ["renew"]),
    ],
)
def test_a_file_of_a_keystore_that_is_damaged_is_one_line_and_nothing_is_changed(
    store: Path, capsys: CAPSYS, file: str, commands: list[str], data: bytes
) -> None:
    (store / file).write_bytes(data)
    before = {one: one.read_bytes() for one in store.rglob("*") if one.is_file()}
    capsys.readouterr()
    for command in commands:
        enclave = [] if command == "list" else [LISTENER]
        assert main([command, str(store), *enclave]) != 0
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("edgevox-security: ")
    assert {one: one.read_bytes() for one in store.rglob("*") if one.is_file()} == before


def test_a_purpose_that_is_damaged_hides_no_other_enclave(store: Path, capsys: CAPSYS) -> None:
    (store / "enclaves/edgevox/listener/edgevox.json").write_text("{}")
    capsys.readouterr()
    assert main(["list", str(store)]) == 0
    assert LISTENER in (told := capsys.readouterr().out)
    assert "/edgevox/edgevox" in told


def test_an_authority_that_has_ended_signs_nothing(tmp_path: Path, capsys: CAPSYS) -> None:
    now = datetime.now(UTC).replace(microsecond=0)
    Keystore.create(tmp_path / "old", now - timedelta(days=10), days=3)
    assert main(["add", str(tmp_path / "old"), "robot"]) == 1
    assert "authority: it ended" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["--domain", "233"], ["--days", "0"], ["--days", "x"]])
def test_numbers_have_bounds(store: Path, arguments: list[str], capsys: CAPSYS) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["add", str(store), "listener", "--enclave", "/x", *arguments])
    assert ended.value.code == 2
    assert arguments[0] in capsys.readouterr().err


def test_the_domain_is_that_of_the_environment(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert main(["add", str(store), "listener", "--enclave", "/x"]) == 0
    assert Keystore(store).purpose("/x").domain == 42
