"""What the doctor says of the console: where it listens, whom that lets in, and its certificate."""

import socket
from datetime import UTC, datetime, timedelta

import pytest
from console_rig import console
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from doctor_rig import ERROR, OK, SKIPPED, WARNING, levels, situation

from edgevox.apps.doctor.console import judge_console, probe_console
from edgevox.console.certificates import own_tls

FREE = {"on": True, "missing": [], "listens": "", "answers": False, "tls": "own", "certificate": {}}
HERE = FREE | {"address": "127.0.0.1:8443", "loopback": True}
ALL = FREE | {"address": "0.0.0.0:8443", "loopback": False}


@pytest.mark.parametrize(
    ("facts", "wanted"),
    [
        ({"on": False}, [SKIPPED]),
        (HERE, [OK]),
        (ALL, [OK]),
        (ALL | {"tls": "off"}, [WARNING]),
        (HERE | {"tls": "off"}, [OK]),
        (HERE | {"missing": ["aiohttp"]}, [ERROR]),
        (HERE | {"listens": "Address already in use"}, [WARNING]),
        (HERE | {"listens": "Address already in use", "answers": True}, [OK]),
        (HERE | {"listens": "Cannot assign requested address"}, [ERROR]),
        (ALL | {"certificate": {"wrong": "no such file"}}, [OK, ERROR]),
        (ALL | {"certificate": {"names": ["a"], "days": 90}}, [OK, OK]),
        (ALL | {"certificate": {"names": ["a"], "days": 3}}, [OK, WARNING]),
        (ALL | {"certificate": {"names": ["a"], "days": -1}}, [OK, ERROR]),
    ],
)
def test_it_is_as_bad_as_it_is(facts, wanted):
    assert levels(judge_console(facts, situation())) == wanted


def test_one_that_is_off_is_not_looked_at():
    assert probe_console(situation()) == {"on": False}


def test_a_port_that_another_has_is_found(monkeypatch):
    monkeypatch.setattr("edgevox.apps.doctor.console.ANSWER_S", 0.1)
    with socket.create_server(("127.0.0.1", 0)) as other:
        facts = probe_console(situation(console=True, console_port=other.getsockname()[1]))
    assert facts["listens"] == "Address already in use"
    assert facts["answers"] is False
    assert facts["loopback"] is True


@pytest.mark.parametrize("tls", ["own", "off"])
def test_a_console_that_runs_is_told_from_another_that_has_its_port(tmp_path, tls):
    encrypted = own_tls(tmp_path, ("localhost",)) if tls == "own" else None
    with console(tmp_path, encrypted) as rig:
        port = rig.server.port
        facts = probe_console(situation(console=True, console_port=port, console_tls=tls))
    assert facts["listens"]
    assert facts["answers"] is True


@pytest.fixture
def certificate(tmp_path):
    """Writes a certificate for robot1.local with its key; the settings that name them."""

    def written(days=90, key=None, names=("robot1.local",)):
        own = ec.generate_private_key(ec.SECP256R1())
        name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "robot1")])
        now = datetime.now(UTC)
        made = x509.CertificateBuilder().subject_name(name).issuer_name(name)
        made = made.public_key(own.public_key()).serial_number(1)
        made = made.not_valid_before(now - timedelta(days=300))
        made = made.not_valid_after(now + timedelta(days=days, hours=1))
        if names:
            alternatives = x509.SubjectAlternativeName([x509.DNSName(one) for one in names])
            made = made.add_extension(alternatives, critical=False)
        leaf, secret = tmp_path / "leaf.pem", tmp_path / "key.pem"
        leaf.write_bytes(made.sign(own, hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
        secret.write_bytes(
            (key or own).private_bytes(
                serialization.Encoding.PEM,
                serialization.PrivateFormat.PKCS8,
                serialization.NoEncryption(),
            )
        )
        return {"console_certificate": str(leaf), "console_key": str(secret)}

    return written


def look(**files):
    return probe_console(situation(console=True, console_tls="files", **files))["certificate"]


def test_a_sites_certificate_is_told_with_its_names_and_days(certificate):
    assert look(**certificate()) == {"names": ["robot1.local"], "days": 90}


def test_one_that_is_over_has_no_days_left(certificate):
    assert look(**certificate(days=-2))["days"] < 0


def test_what_is_wrong_with_a_certificate_is_told(certificate):
    other = ec.generate_private_key(ec.SECP256R1())
    assert look(**certificate(key=other))["wrong"] == "the key is that of another certificate"
    assert "subjectAltName" in look(**certificate(names=()))["wrong"]
    files = certificate()
    assert (
        "gone.pem" in look(**files | {"console_key": f"{files['console_key']}.gone.pem"})["wrong"]
    )
    assert (
        "certificate or key"
        in look(**files | {"console_certificate": files["console_key"]})["wrong"]
    )
