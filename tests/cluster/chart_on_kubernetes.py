"""The chart as Kubernetes itself takes it: `make cluster`. Not part of `make test`.

A control plane without a node: what is admitted, made, replaced and left behind, but no container.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from control_plane import Cluster, control_plane
from release import CHART, KINDS, RELEASE, Release
from waiting import wait_until

OUT_OF_REACH = {"node.kubernetes.io/unreachable", "node.kubernetes.io/not-ready"}


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with control_plane(tmp_path_factory.mktemp("cluster")) as made:
        yield made


@pytest.fixture
def release(cluster: Cluster, request: pytest.FixtureRequest) -> Release:
    return Release(cluster, f"t{request.session.items.index(request.node)}")


def test_a_release_is_admitted_without_a_warning_and_leaves_nothing_behind(release) -> None:
    spread = {"maxSkew": 1, "topologyKey": "zone", "whenUnsatisfiable": "ScheduleAnyway"}
    said = release.put(2, image={"tag": "a"}, topologySpreadConstraints=[spread])
    assert "warning" not in said.lower()
    wait_until(release.runs("a", 2), "the pods")

    release.helm("uninstall", "fleet")
    left = lambda: release.cluster.get(release.namespace, KINDS, RELEASE)  # noqa: E731
    wait_until(lambda: not left(), "the end of all objects")
    claims = release.cluster.get(release.namespace, "persistentvolumeclaims")
    assert not claims


def test_an_upgrade_replaces_a_pod_that_never_became_ready_and_so_does_a_roll_back(release):
    release.put(image={"tag": "broken"})
    wait_until(release.runs("broken"), "the first pod")
    release.put(image={"tag": "good"})
    wait_until(release.runs("good"), "the pod that was mended")
    release.helm("rollback", "fleet", "1")
    wait_until(release.runs("broken"), "the pod of before")


def test_in_order_it_would_not_which_is_why_it_is_not(release, tmp_path) -> None:
    release.put(chart=_in_order(tmp_path), image={"tag": "broken"})
    wait_until(release.runs("broken"), "the first pod")
    before = release.uid()
    release.put(chart=_in_order(tmp_path), image={"tag": "good"})
    wait_until(lambda: _seen(release), "the controller's look at the upgrade")
    assert release.uid() == before

    said = release.put(image={"tag": "good"}, check=False)
    assert "Forbidden: updates to statefulset spec" in said
    orphan = ["delete", "statefulset", "--cascade=orphan", "-l", RELEASE]
    release.cluster.run("kubectl", "-n", release.namespace, *orphan)
    assert release.uid() == before
    release.put(image={"tag": "good"})
    wait_until(release.runs("good"), "the pod of the upgrade")


def test_a_fleet_grows_from_two_to_six_and_back(release) -> None:
    for robots in (2, 6, 2):
        release.put(robots, image={"tag": "a"})
        wait_until(release.runs("a", robots), f"{robots} robots")


def test_a_pod_that_is_killed_comes_back_by_its_name(release) -> None:
    release.put(image={"tag": "a"})
    wait_until(release.runs("a"), "the pod")
    before = release.uid()
    release.cluster.run("kubectl", "-n", release.namespace, "delete", "pod", "fleet-edgevox-r1-0")
    wait_until(lambda: release.pods() and release.uid() != before, "the pod that takes its place")
    assert release.pods()["r1"]["metadata"]["name"] == "fleet-edgevox-r1-0"


def test_a_robot_out_of_reach_is_evicted_by_no_admission_of_the_cluster(release) -> None:
    release.put(image={"tag": "a"})
    wait_until(release.runs("a"), "the pod")
    (pod,) = release.pods().values()
    found = [one for one in pod["spec"]["tolerations"] if one["key"] in OUT_OF_REACH]
    assert len(found) == len(OUT_OF_REACH)
    assert not [one for one in found if "tolerationSeconds" in one]


@pytest.mark.parametrize(
    ("values", "admitted"),
    [
        ({"models": {"volume": {"image": {"reference": "r.example/models:1"}}}}, True),
        ({"models": {"volume": {"persistentVolumeClaim": {"claimName": "x"}}}}, True),
        ({"models": {"volume": {"hostPath": {"path": "/srv"}}}}, False),
        ({"models": {"volume": {"nfs": {"server": "a", "path": "/b"}}}}, False),
        ({"hostNetwork": True}, False),
    ],
)
def test_the_notes_say_of_what_restricted_admits_what_the_cluster_does(
    release, values: dict[str, Any], admitted: bool
) -> None:
    said = release.put(image={"tag": "a"}, **values)
    assert ("would violate PodSecurity" not in said) == admitted
    assert ('"restricted" does not admit its' not in said) == admitted


def _in_order(folder: Path) -> Path:
    """The chart as if its pods were made one after the other, Kubernetes' default."""
    copy = folder / "edgevox"
    if not copy.exists():
        shutil.copytree(CHART, copy)
        workload = copy / "templates" / "statefulset.yaml"
        text = workload.read_text()
        assert "  podManagementPolicy: Parallel\n" in text
        workload.write_text(text.replace("  podManagementPolicy: Parallel\n", ""))
    return copy


def _seen(release: Release) -> bool:
    (workload,) = release.cluster.get(release.namespace, "statefulsets", RELEASE)
    status = workload["status"]
    return status.get("observedGeneration") == workload["metadata"]["generation"] and status.get(
        "updateRevision"
    ) != status.get("currentRevision")
