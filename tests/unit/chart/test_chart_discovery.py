"""Two discovery servers for each domain that asks for them: one may fail."""

from typing import Any

import pytest
from chart_rig import ONE, chart, environment, objects, pods, validate

SERVED = {
    "robots": [
        {"name": "a", "domain": 5, "framePrefix": "a/"},
        {"name": "b", "domain": 5, "framePrefix": "b/"},
        {"name": "c", "domain": 6},
        {"name": "d", "domain": 7, "discovery": {"servers": False}},
    ],
    "discovery": {"servers": True},
}


def _of_servers(kind: str, values: dict[str, Any] = SERVED) -> dict[str, dict[str, Any]]:
    found = [one for one in objects(values, kind) if "-discovery" in one["metadata"]["name"]]
    return {one["metadata"]["name"]: one["spec"] for one in found}


def test_each_domain_has_two_of_its_own_since_a_server_knows_no_domains() -> None:
    found = _of_servers("StatefulSet")

    assert {name: one["replicas"] for name, one in found.items()} == {
        "fleet-edgevox-discovery5": 2,
        "fleet-edgevox-discovery6": 2,
    }
    asked = {
        name: environment(pod).get("ROS_DISCOVERY_SERVER") for name, pod in pods(SERVED).items()
    }
    assert asked["a"] == asked["b"] != asked["c"]
    assert asked["d"] is None


def test_a_robot_names_both_in_the_order_of_their_numbers() -> None:
    servers = environment(pods(SERVED)["c"])["ROS_DISCOVERY_SERVER"].split(";")
    assert servers == [f"fleet-edgevox-discovery6-{number}.robots.svc:11811" for number in range(2)]
    (container,) = _of_servers("StatefulSet")["fleet-edgevox-discovery6"]["template"]["spec"][
        "containers"
    ]
    assert '-i "${HOSTNAME##*-}"' in container["args"][-1]


def test_an_upgrade_takes_one_away_when_all_have_registered_with_the_other() -> None:
    servers = _of_servers("StatefulSet")["fleet-edgevox-discovery5"]
    (container,) = servers["template"]["spec"]["containers"]
    probe = container["startupProbe"]
    assert "sleep 25;" in container["args"][-1]  # longer than the 20 s in which it is missed
    assert probe["periodSeconds"] * probe["failureThreshold"] > 25
    assert servers["minReadySeconds"] > 0


def test_each_has_an_address_that_stays_and_leads_to_its_pod_only() -> None:
    services = _of_servers("Service")
    assert len(services) == 4
    for name, service in services.items():
        assert service["selector"] == {"statefulset.kubernetes.io/pod-name": name}
        assert service.get("clusterIP") != "None"
        assert service["ports"][0]["protocol"] == "UDP"


def test_a_drain_stops_one_at_a_time_and_counts_no_robots() -> None:
    budgets = {
        one["metadata"]["name"]: one["spec"] for one in objects(SERVED, "PodDisruptionBudget")
    }
    of_domain = budgets["fleet-edgevox-discovery5"]
    assert of_domain["maxUnavailable"] == 1
    labels = _of_servers("StatefulSet")["fleet-edgevox-discovery5"]["template"]["metadata"][
        "labels"
    ]
    assert of_domain["selector"]["matchLabels"].items() <= labels.items()
    robots = budgets["fleet-edgevox"]["selector"]["matchLabels"]
    assert not robots.items() <= labels.items()


def test_they_hear_and_answer_robots_of_their_domain_only() -> None:
    policy = _of_servers("NetworkPolicy")["fleet-edgevox-discovery6"]
    ((asks,), (answered,)) = (
        [peer["podSelector"]["matchLabels"] for peer in policy[way][0][who]]
        for way, who in (("ingress", "from"), ("egress", "to"))
    )
    assert asks == answered
    assert asks["edgevox/domain"] == "6"
    assert policy["ingress"][0]["ports"] == [{"protocol": "UDP", "port": 11811}]
    assert policy["egress"][0]["ports"] == [
        {"protocol": "UDP", "port": 7400 + 250 * 6, "endPort": 7400 + 250 * 7 - 1}
    ]


def test_a_robot_may_ask_them_and_hear_their_answers() -> None:
    (policy,) = (
        one["spec"]
        for one in objects(SERVED, "NetworkPolicy")
        if one["metadata"]["name"] == "fleet-edgevox-c"
    )
    for way, who in (("ingress", "from"), ("egress", "to")):
        (peer,) = policy[way][1][who]
        labels = peer["podSelector"]["matchLabels"]
        assert labels["app.kubernetes.io/name"] == "edgevox-discovery"
        assert labels["edgevox/domain"] == "6"
    assert policy["egress"][1]["ports"] == [{"protocol": "UDP", "port": 11811}]
    assert policy["ingress"][1]["ports"] == policy["ingress"][0]["ports"]


@pytest.mark.parametrize("version", ["1.27", "1.37"])
def test_all_of_it_is_what_kubernetes_knows(version: str) -> None:
    for one in chart.documents(chart.render(SERVED)):
        validate(one, version)


def test_nothing_of_it_is_there_unless_it_is_asked_for() -> None:
    assert not _of_servers("StatefulSet", ONE)
