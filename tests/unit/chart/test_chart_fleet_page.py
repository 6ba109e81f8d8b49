"""The page of all robots of a release: which it asks, who may open it, what it may reach."""

import helm_python as helm
import pytest
import yaml
from chart_rig import ONE, chart, objects, validate

TWO = {
    "robots": [
        {"name": "kitchen", "domain": 1, "framePrefix": "k/", "recorder": {"enabled": True}},
        {"name": "yard", "domain": 2, "hostNetwork": True},
    ],
    "console": {"enabled": False},
    "fleetPage": {"enabled": True, "names": ["robots.example"]},
    "networkPolicy": {"console": [{"ipBlock": {"cidr": "10.0.0.0/8"}}]},
}
NAME = "fleet-edgevox-fleet-page"


def page(kind: str, values: dict = TWO) -> dict:
    (one,) = [one for one in objects(values, kind) if one["metadata"]["name"] == NAME]
    return one


def test_without_it_nothing_of_it_is_there() -> None:
    kinds = ("Deployment", "ConfigMap", "Service", "NetworkPolicy")
    made = [one["metadata"]["name"] for kind in kinds for one in objects(ONE, kind)]
    assert NAME not in made


def test_it_asks_each_robot_whose_health_can_be_reached() -> None:
    robots = yaml.safe_load(page("ConfigMap")["data"]["robots.yaml"])["robots"]
    host = "fleet-edgevox-kitchen-0.fleet-edgevox.robots.svc"
    assert robots == {
        "kitchen": {"health": f"http://{host}:8001", "recorder": f"http://{host}:8010"}
    }


def test_its_file_is_one_that_the_program_takes(tmp_path) -> None:
    from edgevox.apps.fleet.watch import load_fleet

    file = tmp_path / "robots.yaml"
    file.write_text(page("ConfigMap")["data"]["robots.yaml"])
    assert list(load_fleet(file)) == ["kitchen"]


def test_it_answers_to_its_own_names_and_has_no_rights() -> None:
    (container,) = page("Deployment")["spec"]["template"]["spec"]["containers"]
    variables = {one["name"]: one["value"] for one in container["env"]}
    assert variables["EDGEVOX_CONSOLE_NAMES"] == f"robots.example,{NAME}.robots.svc"
    assert container["securityContext"]["readOnlyRootFilesystem"] is True
    assert container["securityContext"]["capabilities"] == {"drop": ["ALL"]}


def test_it_may_ask_for_health_and_only_who_may_open_consoles_may_open_it() -> None:
    policy = page("NetworkPolicy")["spec"]
    assert policy["ingress"] == [
        {"from": [{"ipBlock": {"cidr": "10.0.0.0/8"}}], "ports": [{"port": "page"}]}
    ]
    (robot,) = [one for one in objects(TWO, "NetworkPolicy") if one["metadata"]["name"] != NAME]
    selector = policy["podSelector"]
    (let_in,) = [
        one["ports"] for one in robot["spec"]["ingress"] if {"podSelector": selector} in one["from"]
    ]
    assert let_in == [{"port": "health"}, {"port": 8010}]


def test_a_release_of_which_it_can_show_no_robot_is_refused() -> None:
    values = {**TWO, "robots": TWO["robots"][1:]}
    with pytest.raises(helm.HelmError, match=r"fleetPage.enabled: got true, expected a robot"):
        chart.render(values)


@pytest.mark.parametrize("kind", ["ConfigMap", "Deployment", "Service", "NetworkPolicy"])
def test_kubernetes_knows_all_of_it(kind: str) -> None:
    secret = {**TWO["fleetPage"], "tlsSecret": "page"}
    validate(page(kind, {**TWO, "fleetPage": secret}), "1.33.0")
