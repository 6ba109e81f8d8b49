"""The doctor's judgement of DDS security and of the build of ROS 2."""

import pytest
from doctor_rig import ERROR, OK, SKIPPED, WARNING, levels, situation
from enclaves_rig import DAY, NOW, make_enclave

from edgevox.apps.doctor import robots, ros

BUILT = {"middleware": "rmw_fastrtps_cpp", "security": True, "bundled_openssl": ""}


@pytest.fixture
def judged(monkeypatch):
    def judge(build=BUILT, **environment):
        monkeypatch.setattr(ros, "probe_apart", lambda _: build)
        here = situation(environment=environment)
        return ros.judge_security(ros.probe_security(here), here)

    return judge


def test_it_says_which_build_this_is_and_that_nobody_asked(judged):
    build, asked = judged()
    assert levels([build, asked]) == [OK, OK]
    assert "on the system's OpenSSL" in build.found
    assert "not asked for" in asked.found
    wheels, _ = judged(BUILT | {"security": False, "bundled_openssl": "1.1.1k"})
    assert "wheels, with OpenSSL 1.1.1k" in wheels.found
    assert "official image" in wheels.advice


def test_it_says_until_when_an_enclave_is_good(judged, tmp_path):
    make_enclave(tmp_path, "/edgevox/edgevox", ends=NOW + 5 * DAY)
    _, *said = judged(EDGEVOX_SECURITY_KEYSTORE=str(tmp_path))
    assert levels(said) == [WARNING, WARNING, OK]
    assert said[-1].found == f"enforced as /edgevox/edgevox, until {NOW + 5 * DAY:%Y-%m-%d}"


def test_what_would_keep_it_from_starting_is_an_error(judged, tmp_path):
    folder = make_enclave(tmp_path, "/edgevox/edgevox")
    given = {"EDGEVOX_SECURITY_KEYSTORE": str(tmp_path)}
    assert levels(judged(BUILT | {"security": False}, **given)) == [OK, ERROR]
    assert levels(judged(ROS_SECURITY_STRATEGY="Permissive")) == [OK, ERROR]
    here = {**given, "ROS_DOMAIN_ID": "8"}
    found = [one.found for one in judged(**here)[1:]]
    assert found == ["/edgevox/edgevox: permissions.p7s is for ROS_DOMAIN_ID 0, and here it is 8"]
    (folder / "key.pem").unlink()
    _, wrong = judged(**given)
    assert (wrong.level, wrong.found) == (ERROR, "/edgevox/edgevox: key.pem is missing")


def test_in_a_container_it_reads_what_the_entrypoint_set(judged, tmp_path):
    make_enclave(tmp_path, "/edgevox/edgevox")
    set_there = {"ROS_SECURITY_ENABLE": "true", "ROS_SECURITY_STRATEGY": "Enforce"}
    _, named = judged(**set_there)
    assert (named.level, "was not looked at" in named.found) == (OK, True)
    set_there |= {"ROS_SECURITY_KEYSTORE": str(tmp_path)}
    _, said = judged(**set_there, ROS_SECURITY_ENCLAVE_OVERRIDE="/edgevox/edgevox")
    assert (said.level, "enforced as /edgevox/edgevox" in said.found) == (OK, True)


def test_with_it_the_doctor_makes_no_nodes_of_its_own(monkeypatch, tmp_path):
    monkeypatch.setattr(ros, "probe_apart", pytest.fail)
    monkeypatch.setattr(robots, "probe_apart", pytest.fail)
    given = {"ROS_SECURITY_ENABLE": "true"}
    here = situation(environment=given)
    assert ros.judge_round_trip(ros.probe_round_trip(here), here).level is SKIPPED
    here = situation(environment=given, robot_file=tmp_path / "robot.yaml")
    found = robots.probe_robot_file(here)
    assert levels(robots.judge_robot_file(found, here)) == [SKIPPED]
