"""Models on a volume are verified before an upgrade changes a robot, if that is asked for."""

from pathlib import Path
from typing import Any

from chart_rig import objects, pods

from edgevox.apps.models import main

CLAIM = {"persistentVolumeClaim": {"claimName": "models-2", "readOnly": True}}
ASKED = {"models": {"volume": CLAIM, "verify": True}}


def jobs(**values: Any) -> list[dict[str, Any]]:
    robots = [{"name": "a", "domain": 1}, {"name": "b", "domain": 2}]
    return objects({"robots": robots, **values}, "Job")


def test_nothing_waits_for_models_unless_it_is_asked_for_and_there_is_a_volume() -> None:
    assert jobs() == []
    assert jobs(models={"volume": CLAIM}) == []
    assert jobs(models={"verify": True}) == []


def test_each_robots_volume_is_read_before_an_upgrade_but_not_before_the_way_back() -> None:
    found = jobs(**ASKED)

    assert [one["metadata"]["name"] for one in found] == [f"fleet-edgevox-{r}-models" for r in "ab"]
    for one in found:
        assert one["metadata"]["annotations"]["helm.sh/hook"] == "pre-install,pre-upgrade"
        assert one["spec"]["backoffLimit"] == 0
        pod = one["spec"]["template"]["spec"]
        assert pod["restartPolicy"] == "Never"
        assert {"name": "models", **CLAIM} in pod["volumes"]
        (container,) = pod["containers"]
        mounted = {"name": "models", "mountPath": "/opt/edgevox/models", "readOnly": True}
        assert mounted in container["volumeMounts"]


def test_it_runs_the_image_of_the_upgrade_with_a_robots_rights_where_the_robot_may_run() -> None:
    digest = {"digest": f"sha256:{64 * '0'}"}
    values = {"image": digest, "nodeSelector": {"robot": "a"}, "hostNetwork": True, **ASKED}
    job = jobs(**values)[0]["spec"]["template"]["spec"]
    robots = [{"name": "a", "domain": 1, "health": {"port": 1}}]
    robot = pods({**values, "robots": robots})["a"]

    for same in ("securityContext", "nodeSelector", "tolerations", "automountServiceAccountToken"):
        assert job[same] == robot[same]
    for same in ("image", "securityContext"):
        assert job["containers"][0][same] == robot["containers"][0][same]
    assert "hostNetwork" not in job


def test_it_wants_no_device_of_the_robots_and_ends_also_where_it_finds_no_node() -> None:
    sound = {"limits": {"memory": "4Gi", "squat.ai/sound": 1}}
    (job, *_) = jobs(resources=sound, models={**ASKED["models"], "verifySeconds": 60})
    (container,) = job["spec"]["template"]["spec"]["containers"]

    assert job["spec"]["activeDeadlineSeconds"] == 60
    assert set(container["resources"]["limits"]) == {"memory"}


def test_nothing_takes_it_for_a_robot() -> None:
    (robot, *_) = objects({"robots": [{"name": "a", "domain": 1}]}, "StatefulSet")
    (job, *_) = jobs(**ASKED)
    of_the_job = job["spec"]["template"]["metadata"]["labels"].items()

    assert not of_the_job & robot["spec"]["selector"]["matchLabels"].items()


def test_what_it_runs_fails_where_the_volume_is_empty(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    (container,) = jobs(**ASKED)[0]["spec"]["template"]["spec"]["containers"]
    program, *arguments = container["args"]

    assert program == "edgevox-models"
    assert main(arguments) == 1
