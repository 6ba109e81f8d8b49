"""What is read of an enclave's files: nothing but what a participant needs, and when it ends."""

import os
import ssl
from datetime import UTC, datetime

import pytest
from enclaves_rig import DAY, NOW, YEAR, certificate, make_enclave

from edgevox.security.startup import NEEDED, certificate_period, enclaves_of, read_enclave

LONG_AGO = datetime(2001, 2, 3, 4, 5, 6, tzinfo=UTC)


@pytest.mark.parametrize("ends", [NOW, datetime(2049, 12, 31, 23, 59, 59, tzinfo=UTC)])
@pytest.mark.parametrize("later", [0, 20, 5000])
def test_a_certificates_period_is_read_in_each_form_of_time(ends, later):
    """Until 2049 with a year of two digits, from 2050 on of four."""
    ends = ends.replace(year=ends.year + later)
    assert certificate_period(certificate(LONG_AGO, ends)[0]) == (LONG_AGO, ends)


@pytest.mark.parametrize(
    "text",
    ["", "hello", "-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n",
     "-----BEGIN CERTIFICATE-----\n!\n-----END CERTIFICATE-----\n",
     "-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n",
     ssl.DER_cert_to_PEM_cert(bytes.fromhex("30133011" + "020101" * 3 + "3006" + "010100" * 2))],
)  # fmt: skip
def test_what_is_no_certificate_is_a_value_error(text):
    with pytest.raises(ValueError, match="no certificate in PEM"):
        certificate_period(text)


def test_a_good_enclave_says_when_the_first_of_its_files_ends(tmp_path):
    state = read_enclave(make_enclave(tmp_path), NOW, 0)
    assert (state.wrong, state.warnings, state.ends) == ((), (), NOW + YEAR)


@pytest.mark.parametrize("name", NEEDED)
def test_a_file_that_is_missing_is_named(tmp_path, name):
    folder = make_enclave(tmp_path)
    (folder / name).unlink()
    assert read_enclave(folder, NOW, 0).wrong == (f"{name} is missing",)


@pytest.mark.parametrize("name", NEEDED)
@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda at: os.symlink("/dev/zero", at)])
def test_what_is_no_file_is_neither_waited_for_nor_read(tmp_path, name, make):
    folder = make_enclave(tmp_path)
    (folder / name).unlink()
    make(folder / name)
    assert read_enclave(folder, NOW, 0).wrong == (f"{name} is no file of 1000000 bytes at most",)


def test_a_file_without_an_end_in_sight_is_not_read(tmp_path):
    folder = make_enclave(tmp_path)
    os.truncate(folder / "governance.p7s", 1 << 40)
    (said,) = read_enclave(folder, NOW, 0).wrong
    assert said.startswith("governance.p7s is no file of")


def test_a_domain_of_thousands_of_digits_is_no_domain(tmp_path):
    folder = make_enclave(tmp_path)
    permissions = folder / "permissions.p7s"
    many = f"<allow_rule><domains><id>{'7' * 5000}</id></domains></allow_rule>"
    permissions.write_text(permissions.read_text() + many)
    assert read_enclave(folder, NOW, 0).wrong == ()


def test_what_is_over_is_wrong_and_what_ends_soon_is_told(tmp_path):
    over = read_enclave(make_enclave(tmp_path / "1", ends=NOW), NOW, 0)
    at = f"ended {NOW:%Y-%m-%d %H:%M} UTC"
    assert over.wrong == (f"cert.pem {at}", f"permissions.p7s {at}")
    soon = NOW + 29 * DAY
    state = read_enclave(make_enclave(tmp_path / "2", authority_ends=soon), NOW, 0)
    said = [f"{name} ends {soon:%Y-%m-%d}" for name in NEEDED if "_ca" in name]
    assert (state.wrong, list(state.warnings), state.ends) == ((), said, soon)


def test_what_is_not_good_yet_blames_the_clock(tmp_path):
    state = read_enclave(make_enclave(tmp_path, begins=NOW + DAY), NOW, 0)
    assert all(line.endswith("is the clock right?") for line in state.wrong)
    assert len(state.wrong) == 4


def test_a_key_of_another_certificate_or_that_all_may_read_is_told(tmp_path):
    folder = make_enclave(tmp_path)
    (folder / "key.pem").chmod(0o644)
    (warning,) = read_enclave(folder, NOW, 0).warnings
    assert warning.startswith("key.pem can be read by everybody")
    (folder / "key.pem").write_text(certificate(NOW, NOW + DAY)[1])
    assert read_enclave(folder, NOW, 0).wrong == ("key.pem is no key of cert.pem",)
    (folder / "key.pem").write_text("")
    assert read_enclave(folder, NOW, 0).wrong == ("key.pem is no key of cert.pem",)
    (folder / "cert.pem").write_text("")
    assert read_enclave(folder, NOW, 0).wrong == ("cert.pem: no certificate in PEM",)


def test_permissions_that_cannot_be_read_in_the_clear_are_the_middlewares_to_judge(tmp_path):
    folder = make_enclave(tmp_path)
    (folder / "permissions.p7s").write_text("MIIC" * 100)
    assert read_enclave(folder, NOW, 0).wrong == ()


def test_the_enclaves_of_a_secret_in_a_pod_are_not_counted_twice(tmp_path):
    """Kubernetes mounts a Secret as links into a folder that it swaps."""
    folder = make_enclave(tmp_path)
    (folder / "..2026").mkdir()
    for file in [one for one in folder.iterdir() if one.is_file()]:
        file.rename(folder / "..2026" / file.name)
        file.symlink_to(f"..data/{file.name}")
    (folder / "..data").symlink_to("..2026")
    make_enclave(tmp_path, "/robot1/tools")
    assert enclaves_of(tmp_path) == ["/robot1/edgevox", "/robot1/tools"]
    assert read_enclave(folder, NOW, 0).wrong == ()
    assert enclaves_of(tmp_path / "nowhere") == []


def test_what_this_user_may_not_read_is_told_as_that(tmp_path, monkeypatch):
    folder = make_enclave(tmp_path)
    monkeypatch.setattr(os, "access", lambda file, _: "key" not in str(file))
    assert read_enclave(folder, NOW, 0).wrong == (f"key.pem cannot be read by user {os.getuid()}",)


@pytest.mark.parametrize(
    ("domains", "named"),
    [("<id>7</id>", "7"), (" <id> 7 </id>\n <id>12</id> ", "7, 12"),
     ("<id_range><min>7</min><max>9</max></id_range>", "7 to 9"),
     ("<id_range>\n<min>7</min>\n</id_range>", "7 to 232"),
     ("<id>9</id><id_range><max>7</max></id_range>", "9, 0 to 7")],
)  # fmt: skip
def test_permissions_of_another_domain_are_wrong(tmp_path, domains, named):
    folder = make_enclave(tmp_path, domains=domains)
    assert read_enclave(folder, NOW, 7).wrong == ()
    said = f"permissions.p7s is for ROS_DOMAIN_ID {named}, and here it is 233"
    assert read_enclave(folder, NOW, 233).wrong == (said,)


def test_domains_that_are_not_told_in_the_clear_are_left_to_the_middleware(tmp_path):
    assert read_enclave(make_enclave(tmp_path, domains=""), NOW, 5).wrong == ()


@pytest.mark.parametrize(
    ("said", "by"),
    [("<allow_unauthenticated_participants>true<", "allow_unauthenticated_participants"),
     ("<allow_unauthenticated_participants> 1 <", "allow_unauthenticated_participants"),
     ("<enable_join_access_control>\nFALSE<", "enable_join_access_control"),
     ("<allow_unauthenticated_participants>false<", ""), ("<enable_join_access_control>1<", "")],
)  # fmt: skip
def test_a_governance_that_lets_strangers_in_is_wrong(tmp_path, said, by):
    folder = make_enclave(tmp_path)
    (folder / "governance.p7s").write_text(f"signed {said}")
    wrong = (f"governance.p7s lets strangers in, by {by}",) if by else ()
    assert read_enclave(folder, NOW, 0).wrong == wrong
