"""The chart with its robots running, on a Kubernetes of one node: `make cluster`. Needs root."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from control_plane import Cluster
from node import node
from release import KINDS, RELEASE, Release
from waiting import wait_until

IMAGE = "edgevox-ros2"
TAG = "local-slim"
OPERATOR = Path(__file__).with_name("says_and_hears.py").read_text()
SMALL = {"requests": {"cpu": "50m", "memory": "64Mi"}}
LEFT = f"{KINDS},endpointslices,controllerrevisions"


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with node(tmp_path_factory.mktemp("node"), f"{IMAGE}:{TAG}") as made:
        yield made


class Fleet(Release):
    """A release whose robots run, each with the rules alone for a language model."""

    def start(self, robots: int = 1, tag: str = TAG, **values: Any) -> None:
        """Install or upgrade to so many robots, and wait until all of them are ready."""
        self.set(robots, image={"tag": tag}, **values)
        self.come_up(robots)

    def set(self, robots: int = 1, **values: Any) -> None:
        self.put(robots, resources=SMALL, llm={"model": "none"}, **values)

    def come_up(self, robots: int = 1) -> None:
        for number in range(1, robots + 1):
            workload = f"statefulset/fleet-edgevox-r{number}"
            self.kubectl("rollout", "status", "--timeout=10m", workload)

    def kubectl(self, *arguments: str) -> str:
        return self.cluster.run("kubectl", "-n", self.namespace, *arguments).stdout

    def stuck(self) -> str:
        """Why the only robot's container does not run, in Kubernetes' words."""
        for pod in self.pods().values():
            for one in pod["status"].get("containerStatuses", []):
                return str(one["state"].get("waiting", {}).get("reason", ""))
        return ""

    def say(self, words: str) -> None:
        """To r1, by a pod of its own, which listens on."""
        script = f"--from-literal=says_and_hears.py={OPERATOR}"
        self.kubectl("create", "configmap", "operator", script)
        file = self.cluster.folder / f"{self.namespace}-operator.json"
        file.write_text(json.dumps(_operator(words)))
        self.kubectl("apply", "-f", str(file))

    def heard(self, *wanted: str) -> None:
        """Wait until one line that the operator heard has all of this."""
        found = lambda: any(all(w in line for w in wanted) for line in self._lines())  # noqa: E731
        wait_until(found, f"{wanted} on the operator's screen")

    def order(self, *wanted: str) -> list[int]:
        """In which line of the operator's each of this comes first."""
        lines = self._lines()
        return [next(n for n, line in enumerate(lines) if one in line) for one in wanted]

    def _lines(self) -> list[str]:
        logs = ["-n", self.namespace, "logs", "operator"]
        return self.cluster.run("kubectl", *logs, check=False).stdout.splitlines()


def _operator(words: str) -> dict[str, Any]:
    """A pod that Pod Security's "restricted" admits, on the domain of r1."""
    mount = {"name": "script", "mountPath": "/script", "readOnly": True}
    told = {"ROS_DOMAIN_ID": "1", "ROBOT": "/r1", "SAY": words}
    container = {
        "name": "operator",
        "image": f"{IMAGE}:{TAG}",
        "args": ["python3", "/script/says_and_hears.py"],
        "env": [{"name": name, "value": value} for name, value in told.items()],
        "volumeMounts": [mount],
        "securityContext": {
            "allowPrivilegeEscalation": False,
            "capabilities": {"drop": ["ALL"]},
        },
    }
    return {
        "apiVersion": "v1",
        "kind": "Pod",
        "metadata": {"name": "operator"},
        "spec": {
            "automountServiceAccountToken": False,
            "restartPolicy": "Never",
            "terminationGracePeriodSeconds": 1,
            "securityContext": {
                "runAsNonRoot": True,
                "runAsUser": 1000,
                "seccompProfile": {"type": "RuntimeDefault"},
            },
            "containers": [container],
            "volumes": [{"name": "script", "configMap": {"name": "operator"}}],
        },
    }


@pytest.fixture
def fleet(cluster: Cluster, request: pytest.FixtureRequest) -> Iterator[Fleet]:
    made = Fleet(cluster, f"n{request.session.items.index(request.node)}")
    yield made
    cluster.run("kubectl", "delete", "namespace", made.namespace, "--timeout=10m")


def test_a_robot_is_ready_does_what_a_peer_says_and_leaves_nothing(fleet) -> None:
    fleet.start()
    fleet.say("go to the kitchen")
    fleet.heard("navigate_to", "succeeded")
    fleet.heard("I am in the kitchen")

    fleet.helm("uninstall", "fleet")
    left = lambda: fleet.cluster.get(fleet.namespace, LEFT, RELEASE)  # noqa: E731
    wait_until(lambda: not left(), "the end of all objects")


def test_a_robot_whose_pod_is_killed_is_ready_again(fleet) -> None:
    fleet.start()
    before = fleet.uid()
    fleet.kubectl("delete", "pod", "fleet-edgevox-r1-0", "--timeout=10m")
    wait_until(lambda: fleet.pods() and fleet.uid() != before, "the pod that takes its place")
    fleet.come_up()


def test_upgrades_that_break_are_mended_and_rolled_back(fleet) -> None:
    fleet.start()
    fleet.start(tag=f"{TAG}-next")
    for broken, why in (
        ({"image": {"tag": "nowhere"}}, "ImagePullBackOff"),
        ({"image": {"digest": f"sha256:{'0' * 64}"}}, "ImagePullBackOff"),
        ({"image": {"tag": TAG}, "settings": {"EDGEVOX_SEED": "x"}}, "CrashLoopBackOff"),
    ):
        fleet.set(**broken)
        wait_until(lambda why=why: fleet.stuck() == why, why)
        fleet.start()
    fleet.helm("rollback", "fleet", "2")
    wait_until(fleet.runs(f"{TAG}-next"), "the pod of the second revision")
    fleet.come_up()


def test_a_fleet_grows_from_two_robots_to_six_and_back(fleet) -> None:
    for robots in (2, 6, 2):
        fleet.start(robots)
        wait_until(fleet.runs(TAG, robots), f"{robots} robots")


@pytest.mark.parametrize(("drain_s", "end"), [(120, "succeeded"), (0, "skill_cancelled")])
def test_a_robot_on_the_move_is_drained_before_its_pod_ends(fleet, drain_s: int, end: str) -> None:
    fleet.start(drainSeconds=drain_s)
    fleet.say("go to the kitchen")
    fleet.heard("navigate_to", "running")
    fleet.kubectl("delete", "pod", "fleet-edgevox-r1-0", "--timeout=10m")
    fleet.heard('"drained"')
    first, then, last = fleet.order('"draining"', end, '"drained"')
    assert first < then < last
