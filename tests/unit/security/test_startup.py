"""Security that is asked for is enforced, or nothing starts; what ROS 2 reads of it."""

import os
import sys

import pytest
from enclaves_rig import DAY, NOW, make_enclave
from guards import run_program

from edgevox.core.errors import InvalidValue
from edgevox.core.probe import ProbeFailed
from edgevox.ros2.doctor import judged_by
from edgevox.security import startup
from edgevox.security.startup import secured

BUILT = {"middleware": "rmw_fastrtps_cpp", "security": True, "bundled_openssl": "", "taken": True}
ROBOT = {"EDGEVOX_AGENT_NAMESPACE": "/robot1"}
BY_HAND = {"ROS_SECURITY_ENABLE": "true", "ROS_SECURITY_STRATEGY": "Enforce"}


@pytest.fixture
def keystore(tmp_path, monkeypatch):
    """One with an enclave of the robot, on a middleware that has security."""
    monkeypatch.setattr(startup, "probe_apart", lambda *_, **__: BUILT)
    made = tmp_path / "keystore"
    make_enclave(made)
    return made


def _secured(keystore, program="edgevox-agent", **given):
    asked = {**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(keystore), **given}
    return secured(asked, program, lambda text: pytest.fail(f"warned: {text}"))


def _refused(environment):
    with pytest.raises(InvalidValue) as caught:
        secured(environment, "edgevox-agent", pytest.fail)
    return str(caught.value)


def test_unless_it_is_asked_for_nothing_is_looked_at_or_set(monkeypatch):
    monkeypatch.setattr(startup, "probe_apart", pytest.fail)
    for given in ({"A": "b"}, {"ROS_SECURITY_ENABLE": "false"}, {"ROS_SECURITY_KEYSTORE": "/x"}):
        assert secured(given, "edgevox-agent", pytest.fail) == given
    empty = {"EDGEVOX_SECURITY_KEYSTORE": "", "EDGEVOX_SECURITY_ENCLAVE": ""}
    assert secured(empty, "bash", pytest.fail) == {}


def test_asked_for_it_is_enforced_with_the_robots_own_enclave(keystore):
    assert _secured(keystore) == {
        **ROBOT,
        "ROS_SECURITY_ENABLE": "true",
        "ROS_SECURITY_STRATEGY": "Enforce",
        "ROS_SECURITY_KEYSTORE": str(keystore),
        "ROS_SECURITY_ENCLAVE_OVERRIDE": "/robot1/edgevox",
    }


def test_what_it_made_it_takes_again(keystore):
    """A shell in the container passes the entrypoint a second time."""
    once = _secured(keystore)
    assert secured(once, "bash", pytest.fail) == once
    assert _secured(keystore, **once) == once


@pytest.mark.parametrize(
    ("program", "name"),
    [("edgevox-agent", "edgevox"), ("edgevox", "edgevox"), ("bash", "tools"), ("ros2", "tools"),
     ("/opt/edgevox/bin/edgevox-recorder", "edgevox_recorder")],
)  # fmt: skip
def test_of_several_enclaves_each_program_takes_its_own(keystore, program, name):
    for more in ("/robot1/edgevox_recorder", "/robot1/tools", "/robot10/edgevox"):
        make_enclave(keystore, more)
    enclave = _secured(keystore, program)["ROS_SECURITY_ENCLAVE_OVERRIDE"]
    assert enclave == f"/robot1/{name}"


def test_the_only_one_of_the_robot_is_everybodys_and_one_that_is_named_counts(keystore):
    assert _secured(keystore, "bash")["ROS_SECURITY_ENCLAVE_OVERRIDE"] == "/robot1/edgevox"
    make_enclave(keystore, "/annas/laptop")
    chosen = _secured(keystore, EDGEVOX_SECURITY_ENCLAVE="/annas/laptop")
    assert chosen["ROS_SECURITY_ENCLAVE_OVERRIDE"] == "/annas/laptop"


@pytest.mark.parametrize("strategy", ["Permissive", "permissive", "enforce", "true"])
@pytest.mark.parametrize("asked", [True, False])
def test_less_than_enforced_is_refused_even_if_nobody_asks(keystore, strategy, asked):
    given = {**ROBOT, "ROS_SECURITY_STRATEGY": strategy}
    given |= {"EDGEVOX_SECURITY_KEYSTORE": str(keystore)} if asked else {}
    assert _refused(given) == f"ROS_SECURITY_STRATEGY: got {strategy!r}, expected Enforce"


@pytest.mark.parametrize(
    ("name", "value"),
    [("ROS_SECURITY_ENABLE", "false"), ("ROS_SECURITY_ENABLE", "True"),
     ("ROS_SECURITY_KEYSTORE", "/other"), ("ROS_SECURITY_ENCLAVE_OVERRIDE", "/other")],
)  # fmt: skip
def test_what_is_set_by_hand_must_say_the_same(keystore, name, value):
    given = {**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(keystore), name: value}
    assert _refused(given).startswith(f"{name}: got {value!r}, expected ")


def test_security_by_hand_is_left_alone_if_it_is_enforced():
    assert secured(BY_HAND, "edgevox-agent", pytest.fail) == BY_HAND
    said = _refused({"ROS_SECURITY_ENABLE": "true"})
    assert said.startswith("ROS_SECURITY_STRATEGY: got '', expected Enforce")


@pytest.mark.parametrize("word", ["True", "1", "yes", "TRUE", "on", "enforce"])
def test_a_word_that_ros_2_takes_for_no_is_refused(word):
    said = _refused({**BY_HAND, "ROS_SECURITY_ENABLE": word})
    assert said == f"ROS_SECURITY_ENABLE: got {word!r}, expected true or false, in these letters"


def test_what_is_asked_for_by_halves_is_refused(keystore, tmp_path):
    assert _refused({"EDGEVOX_SECURITY_ENCLAVE": "/a"}).startswith("EDGEVOX_SECURITY_ENCLAVE: got")
    said = _refused({"EDGEVOX_SECURITY_KEYSTORE": str(tmp_path / "none")})
    assert said.startswith("EDGEVOX_SECURITY_KEYSTORE: got")
    other = {"EDGEVOX_SECURITY_KEYSTORE": str(keystore), "EDGEVOX_AGENT_NAMESPACE": "/robot2"}
    assert _refused(other) == (
        "EDGEVOX_SECURITY_ENCLAVE: got '/robot2/edgevox', expected one of the keystore:"
        " /robot1/edgevox"
    )


def test_an_enclave_that_is_over_stops_it_and_one_that_ends_soon_is_told(keystore, tmp_path):
    over, soon = tmp_path / "over", tmp_path / "soon"
    make_enclave(over, ends=NOW)
    make_enclave(soon, ends=NOW + 5 * DAY)
    said = _refused({**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(over)})
    assert "cert.pem ended" in said
    told = []
    secured({**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(soon)}, "edgevox-agent", told.append)
    assert [line.partition(" ends ")[0] for line in told] == [
        "security: /robot1/edgevox: cert.pem",
        "security: /robot1/edgevox: permissions.p7s",
    ]


def test_the_authoritys_own_keystore_is_refused(keystore):
    (keystore / "private").mkdir()
    said = _refused({**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(keystore)})
    assert said.startswith("EDGEVOX_SECURITY_KEYSTORE: got ")
    assert "what edgevox-security exports" in said


@pytest.mark.parametrize("domain", ["x", "-1", "233", "٣"])
def test_a_domain_that_is_none_is_refused(keystore, domain):
    given = {"EDGEVOX_SECURITY_KEYSTORE": str(keystore), "ROS_DOMAIN_ID": domain}
    assert _refused({**ROBOT, **given}).startswith(
        f"ROS_DOMAIN_ID: got {domain!r}, expected a whole number"
    )


def test_an_enclave_of_another_domain_is_refused(keystore):
    given = {"EDGEVOX_SECURITY_KEYSTORE": str(keystore), "ROS_DOMAIN_ID": "8"}
    assert "permissions.p7s is for ROS_DOMAIN_ID 0" in _refused({**ROBOT, **given})


def test_an_enclave_that_the_middleware_does_not_take_is_refused(keystore, monkeypatch):
    asked = []

    def probe(address, *_, environment=None, **__):
        asked.append(environment)
        return BUILT | {"taken": False}

    monkeypatch.setattr(startup, "probe_apart", probe)
    said = _refused({**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(keystore), "ROS_DOMAIN_ID": "0"})
    assert said.startswith("EDGEVOX_SECURITY_ENCLAVE: got '/robot1/edgevox', expected a good one")
    assert "as they were signed" in said
    assert asked[1]["ROS_SECURITY_ENCLAVE_OVERRIDE"] == "/robot1/edgevox"
    assert asked[1]["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "OFF"


@pytest.mark.parametrize(
    ("facts", "why"),
    [(BUILT | {"security": False}, "here is rmw_fastrtps_cpp without it"),
     (BUILT | {"security": False, "middleware": ""}, "here is no ROS 2 without it"),
     (None, "it hangs")],
)  # fmt: skip
def test_without_security_in_the_middleware_nothing_starts(keystore, monkeypatch, facts, why):
    def probe(*_, **__):
        if facts is None:
            raise ProbeFailed("it hangs: no answer within 60 s")
        return facts

    monkeypatch.setattr(startup, "probe_apart", probe)
    said = _refused({**ROBOT, "EDGEVOX_SECURITY_KEYSTORE": str(keystore)})
    assert said.startswith("EDGEVOX_SECURITY_KEYSTORE: got ")
    assert "expected a middleware" in said
    assert why in said


def test_the_entrypoint_ends_with_one_line_and_64_before_anything_starts(keystore):
    given = {"PATH": os.environ["PATH"], **ROBOT, "ROS_SECURITY_STRATEGY": "Permissive"}
    ran = run_program(
        [sys.executable, "-m", "edgevox.apps.container.start", "echo", "started"],
        env=given | {"EDGEVOX_SECURITY_KEYSTORE": str(keystore)},
    )
    assert (ran.returncode, ran.stdout) == (64, "")
    said = "edgevox: ROS_SECURITY_STRATEGY: got 'Permissive', expected Enforce\n"
    assert ran.stderr == said


def test_a_build_is_told_by_its_libraries(tmp_path):
    with_it, without = tmp_path / "libfastrtps.so.2.14", tmp_path / "libfastdds.so.3"
    with_it.write_bytes(b"\x7fELF dds.sec.auth.builtin.PKI-DH.identity_ca\0")
    without.write_bytes(b"\x7fELF\0")
    other = tmp_path / "libother.so"
    other.write_bytes(with_it.read_bytes())
    wheels = "/usr/lib/ros_rmw.libs/libssl-60250281.so.1.1.1k"
    assert judged_by({str(with_it)}) == {"security": True, "bundled_openssl": ""}
    assert judged_by({str(without), str(other), "/usr/lib/libssl.so.3"}) == {
        "security": False,
        "bundled_openssl": "",
    }
    assert judged_by({wheels})["bundled_openssl"] == "1.1.1k"
