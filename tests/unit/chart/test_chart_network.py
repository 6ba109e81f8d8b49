"""Who may talk to whom: robots of one domain, on its ports; nobody else."""

import ipaddress
from typing import Any

from chart_rig import ONE, environment, objects, pods

SHARED = {
    "robots": [
        {"name": "a", "domain": 5, "framePrefix": "a/"},
        {"name": "b-1", "domain": 5, "framePrefix": "b/"},
        {"name": "c", "domain": 6},
        {"name": "d", "domain": 5, "framePrefix": "d/", "hostNetwork": True},
    ]
}


def policies(values: dict[str, Any]) -> dict[str, dict[str, Any]]:
    found = objects(values, "NetworkPolicy")
    return {one["metadata"]["labels"]["edgevox/robot"]: one["spec"] for one in found}


def dds_ports(values: dict[str, Any], robot: str) -> tuple[int, int]:
    (port,) = policies(values)[robot]["ingress"][0]["ports"]
    assert port["protocol"] == "UDP"
    return port["port"], port["endPort"]


def test_dds_is_let_in_from_robots_of_the_same_domain_only() -> None:
    for spec in policies(SHARED).values():
        (rule,) = spec["ingress"]
        domain = "6" if spec["podSelector"]["matchLabels"]["edgevox/robot"] == "c" else "5"
        (peer,) = rule["from"]
        assert peer["podSelector"]["matchLabels"]["edgevox/domain"] == domain
        assert peer["podSelector"]["matchLabels"]["app.kubernetes.io/instance"] == "fleet"
        assert spec["policyTypes"] == ["Ingress", "Egress"]


def test_the_ports_are_the_ones_of_the_domain() -> None:
    assert dds_ports(ONE, "solo") == (7400 + 7 * 250, 7400 + 8 * 250 - 1)
    last = {"robots": [{"name": "solo", "domain": 232}]}
    assert dds_ports(last, "solo") == (65400, 65535)


def test_no_policy_is_pretended_on_the_hosts_network() -> None:
    assert policies(SHARED).keys() == {"a", "b-1", "c"}


def test_a_robot_reaches_names_and_its_domain_and_nothing_else() -> None:
    dds, names = policies(ONE)["solo"]["egress"]

    assert dds["to"][0]["podSelector"]["matchLabels"]["edgevox/domain"] == "7"
    assert {(p["protocol"], p["port"]) for p in names["ports"]} == {("UDP", 53), ("TCP", 53)}


def test_an_endpoint_is_reached_on_its_port() -> None:
    for url, port in {
        "http://llm:8080": 8080,
        "http://llm": 80,
        "https://llm.example/v1": 443,
        "https://[fd00::1]:8443/v1": 8443,
    }.items():
        rule = policies(ONE | {"llm": {"endpoint": url}})["solo"]["egress"][-1]
        assert rule == {"ports": [{"protocol": "TCP", "port": port}]}


def test_servers_that_hear_and_speak_are_reached_on_their_ports() -> None:
    speech = {"stt": {"endpoint": "tcp://speech:10300"}, "tts": {"endpoint": "https://speech/v1"}}
    lan = {"ipBlock": {"cidr": "192.168.1.0/24"}}
    anywhere = policies(ONE | speech)["solo"]["egress"]
    near = policies(ONE | speech | {"networkPolicy": {"speech": [lan]}})["solo"]["egress"]

    assert anywhere[-2:] == [
        {"ports": [{"protocol": "TCP", "port": port}]} for port in (10300, 443)
    ]
    assert near[-2:] == [one | {"to": [lan]} for one in anywhere[-2:]]


def test_who_else_is_named_may_talk_both_ways() -> None:
    lan = {"ipBlock": {"cidr": "192.168.1.0/24"}}
    monitoring = {"namespaceSelector": {"matchLabels": {"a": "b"}}}
    network = {"peers": [lan], "monitoring": [monitoring], "llm": [lan]}
    spec = policies(ONE | {"networkPolicy": network, "llm": {"endpoint": "http://llm"}})["solo"]

    assert lan in spec["ingress"][0]["from"]
    assert lan in spec["egress"][0]["to"]
    assert spec["ingress"][1] == {"from": [monitoring], "ports": [{"port": "health"}]}
    assert spec["egress"][-1]["to"] == [lan]


def test_prometheus_is_let_in_to_metrics_only_if_it_was_asked_for() -> None:
    monitored = ONE | {"serviceMonitor": {"enabled": True}}
    peer = {"namespaceSelector": {"matchLabels": {"a": "b"}}}
    (dds,) = policies(monitored)["solo"]["ingress"]
    assert all(port["protocol"] == "UDP" for port in dds["ports"])

    _, rule = policies(monitored | {"networkPolicy": {"monitoring": [peer]}})["solo"]["ingress"]
    assert rule == {"from": [peer], "ports": [{"port": "health"}, {"port": "metrics"}]}


def test_policies_can_be_left_to_others() -> None:
    assert policies(SHARED | {"networkPolicy": {"enabled": False}}) == {}


def test_robots_of_one_domain_are_told_of_each_other_by_names_that_stay() -> None:
    found = {name: environment(pod).get("ROS_STATIC_PEERS") for name, pod in pods(SHARED).items()}
    (service,) = objects(SHARED, "Service")
    of_a, of_b = (f"fleet-edgevox-{n}-0.fleet-edgevox.robots.svc" for n in ("a", "b-1"))

    assert found == {"a": of_b, "b-1": of_a, "c": None, "d": f"{of_a};{of_b}"}
    assert service["spec"]["clusterIP"] == "None"
    assert service["spec"]["publishNotReadyAddresses"] is True


def test_peers_of_ones_own_come_first() -> None:
    discovery = {"staticPeers": ["192.168.1.7", "base.local"], "amongRobots": False}
    peers = environment(pods(SHARED | {"discovery": discovery})["a"])["ROS_STATIC_PEERS"]

    assert peers == "192.168.1.7;base.local"
    assert ipaddress.ip_address(peers.split(";")[0])
