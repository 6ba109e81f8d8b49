"""What the chart makes of DDS security: each robot its own enclave, and nobody else's."""

from typing import Any

import helm_python as helm
import pytest
from chart_rig import ONE, chart, environment, objects, pods, solo, validate

VERSIONS = ("1.27", "1.37")
ON = {"enabled": True}
SITE = {
    "robots": [
        {"name": "robot-1", "domain": 1},
        {"name": "b", "domain": 2, "agentNamespace": "/x/b", "security": {"secretName": "mine"}},
        {"name": "c", "domain": 3, "security": {"enclave": "/site/c"}},
    ],
    "security": ON,
    "recorder": {"enabled": True},
}
KEYSTORE = "/etc/edgevox/security"


def _mounts(container: dict[str, Any]) -> dict[str, str]:
    found = [one for one in container["volumeMounts"] if one["mountPath"].startswith(KEYSTORE)]
    assert all(one["readOnly"] for one in found)
    return {one["name"]: one["mountPath"].removeprefix(f"{KEYSTORE}/enclaves") for one in found}


def _secrets(pod: dict[str, Any]) -> dict[str, str]:
    found = {one["name"]: one["secret"] for one in pod["volumes"] if "secret" in one}
    assert {one["defaultMode"] for one in found.values()} == {0o440}
    assert pod["securityContext"]["fsGroup"] == pod["securityContext"]["runAsGroup"]
    return {name: one["secretName"] for name, one in found.items()}


def test_helm_and_kubernetes_take_it() -> None:
    assert helm.lint(str(chart.CHART), SITE, strict=True)["errors"] == []
    for one in chart.documents(chart.render(SITE)):
        for version in VERSIONS:
            validate(one, version)


def test_unless_it_is_asked_for_no_pod_has_an_enclave() -> None:
    pod = solo(recorder={"enabled": True})
    assert [one["name"] for one in pod["volumes"] if "secret" in one] == []
    for container in pod["containers"]:
        assert not _mounts(container)
        assert "EDGEVOX_SECURITY_KEYSTORE" not in [one["name"] for one in container["env"]]


def test_each_robot_has_a_secret_of_its_own_and_its_recorder_another() -> None:
    """Where nothing is named, by the names that edgevox-security gives them."""
    made = pods(SITE)
    assert _secrets(made["robot-1"]) == {
        "security": "edgevox-security-robot-1-edgevox",
        "recorder-security": "edgevox-security-robot-1-edgevox-recorder",
    }
    assert _secrets(made["b"])["security"] == "mine"
    assert _secrets(made["b"])["recorder-security"] == "edgevox-security-x-b-edgevox-recorder"
    assert _secrets(made["c"])["security"] == "edgevox-security-site-c"


@pytest.mark.parametrize(
    ("name", "own", "of_recorder"),
    [
        ("robot-1", "/robot_1/edgevox", "/robot_1/edgevox_recorder"),
        ("b", "/x/b/edgevox", "/x/b/edgevox_recorder"),
        ("c", "/site/c", "/c/edgevox_recorder"),
    ],
)
def test_each_container_has_its_enclave_and_not_the_others(name, own, of_recorder) -> None:
    pod = pods(SITE)[name]
    robot, recorder = pod["containers"]
    assert _mounts(robot) == {"security": own}
    assert _mounts(recorder) == {"recorder-security": of_recorder}
    assert environment(pod)["EDGEVOX_SECURITY_KEYSTORE"] == KEYSTORE
    assert environment(pod).get("EDGEVOX_SECURITY_ENCLAVE") == ("/site/c" if name == "c" else None)
    given = {one["name"]: one["value"] for one in recorder["env"]}
    assert given["EDGEVOX_SECURITY_KEYSTORE"] == KEYSTORE
    assert "EDGEVOX_SECURITY_ENCLAVE" not in given


def test_one_robot_of_a_release_may_be_secured_alone() -> None:
    robots = [{"name": "a", "domain": 1}, {"name": "b", "domain": 2, "security": ON}]
    made = pods({"robots": robots})
    assert [bool(_mounts(made[name]["containers"][0])) for name in "ab"] == [False, True]


def test_the_chart_makes_no_secret_itself() -> None:
    assert objects(SITE, "Secret") == []


def test_without_security_the_names_of_secrets_say_nothing() -> None:
    assert solo(security={"secretName": "one"})["volumes"] == pods(ONE)["solo"]["volumes"]
