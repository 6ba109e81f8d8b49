"""What the chart makes of a console: off unless asked for, and then let in by nobody unnamed."""

from typing import Any

import helm_python as helm
import pytest
from chart_rig import ONE, chart, environment, objects, pods, solo, validate

VERSIONS = ("1.27", "1.37")
SITE = {
    "robots": [
        {"name": "a", "domain": 1, "console": {"ingress": {"host": "a.example"}}},
        {"name": "b", "domain": 2, "console": {"ingress": {"host": "b.example"}}},
    ],
    "console": {
        "enabled": True,
        "names": ["robots.local", "192.168.1.7"],
        "tlsSecret": "console",
        "volume": {"hostPath": {"path": "/srv"}},
        "service": {"type": "LoadBalancer", "annotations": {"a": "b"}},
        "ingress": {"enabled": True, "className": "nginx", "tlsSecret": "site"}
        | {"annotations": {"nginx.ingress.kubernetes.io/backend-protocol": "HTTPS"}},
    },
    "networkPolicy": {"console": [{"namespaceSelector": {"matchLabels": {"a": "ingress"}}}]},
    "recorder": {"enabled": True},
}
ON = ONE | {"console": {"enabled": True}}


def console_services(values: dict[str, Any]) -> list[dict[str, Any]]:
    found = objects(values, "Service")
    return [one for one in found if one["metadata"]["name"].endswith("-console")]


def ingress_rules(values: dict[str, Any]) -> list[dict[str, Any]]:
    return [one["spec"]["ingress"] for one in objects(values, "NetworkPolicy")]


@pytest.mark.parametrize("values", [ON, SITE])
def test_helm_and_kubernetes_take_it(values: dict[str, Any]) -> None:
    assert helm.lint(str(chart.CHART), values, strict=True)["errors"] == []
    for one in chart.documents(chart.render(values)):
        for version in VERSIONS:
            validate(one, version)


def test_unless_it_is_asked_for_nothing_listens_and_nothing_leads_there() -> None:
    pod = solo()

    assert [name for name in environment(pod) if "CONSOLE" in name] == []
    assert [one["name"] for one in pod["containers"][0]["ports"]] == ["health"]
    assert "console" not in [one["name"] for one in pod["volumes"]]
    assert console_services(ONE) == objects(ONE, "Ingress") == []


def test_it_is_let_in_by_those_that_are_named_and_by_nobody_else() -> None:
    (closed,) = ingress_rules(ON)
    assert [port for rule in closed for port in rule["ports"]] == [
        {"endPort": 9399, "port": 9150, "protocol": "UDP"}
    ]
    for rules in ingress_rules(SITE):
        (rule,) = [one for one in rules if {"port": "console"} in one["ports"]]
        assert rule["from"] == SITE["networkPolicy"]["console"]


def test_each_robot_has_a_service_and_an_ingress_that_lead_to_it_alone() -> None:
    services, ingresses = console_services(SITE), objects(SITE, "Ingress")
    assert [one["spec"]["selector"]["edgevox/robot"] for one in services] == ["a", "b"]
    for robot, service, ingress in zip("ab", services, ingresses, strict=True):
        (rule,) = ingress["spec"]["rules"]
        (path,) = rule["http"]["paths"]
        assert path["backend"]["service"]["name"] == service["metadata"]["name"]
        assert rule["host"] == f"{robot}.example"
        assert ingress["spec"]["tls"] == [{"hosts": [rule["host"]], "secretName": "site"}]


def test_the_pod_listens_where_the_service_leads_and_keeps_who_is_paired() -> None:
    pod = pods(ON)["solo"]
    (container,) = pod["containers"]
    given = environment(pod)
    mounts = {one["name"]: one for one in container["volumeMounts"]}
    volumes = {one["name"]: one for one in pod["volumes"]}

    assert {"name": "console", "containerPort": 8443} in container["ports"]
    assert given["EDGEVOX_CONSOLE"] == "true"
    assert given["EDGEVOX_CONSOLE_PORT"] == "8443"
    assert given["EDGEVOX_CONSOLE_HOST"] == "0.0.0.0"  # noqa: S104 - a pod's own
    assert given["EDGEVOX_CONSOLE_NAMES"] == "fleet-edgevox-solo-console.robots.svc"
    assert given["EDGEVOX_CONSOLE_FOLDER"] == mounts["console"]["mountPath"]
    assert volumes["console"] == {"name": "console", "emptyDir": {"sizeLimit": "16Mi"}}
    assert "EDGEVOX_CONSOLE_TLS" not in given  # its own certificate


def test_recordings_have_a_volume_that_holds_what_the_robot_may_write() -> None:
    common = {"enabled": True, "recordings": {"mb": 300, "volume": {"hostPath": {"path": "/a"}}}}
    claim = {"persistentVolumeClaim": {"claimName": "b"}}
    own = [{"name": "b", "domain": 2, "console": {"recordings": {"volume": claim}}}]
    for values, mb, source in (
        (ON, "1000", {"emptyDir": {"sizeLimit": "1100M"}}),
        ({"robots": ONE["robots"], "console": common}, "300", {"hostPath": {"path": "/a"}}),
        ({"robots": own, "console": common}, "300", claim),
    ):
        (pod,) = pods(values).values()
        given = environment(pod)
        (mount,) = [
            one
            for one in pod["containers"][0]["volumeMounts"]
            if one["name"] == "console-recordings"
        ]
        (volume,) = [one for one in pod["volumes"] if one["name"] == "console-recordings"]
        assert given["EDGEVOX_CONSOLE_RECORDINGS"] == mount["mountPath"]
        assert given["EDGEVOX_CONSOLE_RECORDINGS_MB"] == mb
        assert volume == {"name": "console-recordings", **source}


def test_a_sites_certificate_takes_the_place_of_its_own() -> None:
    pod = pods(SITE)["a"]
    given = environment(pod)
    (mount,) = [o for o in pod["containers"][0]["volumeMounts"] if o["name"] == "console-tls"]
    (volume,) = [one for one in pod["volumes"] if one["name"] == "console-tls"]

    assert given["EDGEVOX_CONSOLE_TLS"] == "files"
    assert given["EDGEVOX_CONSOLE_CERTIFICATE"] == f"{mount['mountPath']}/tls.crt"
    assert given["EDGEVOX_CONSOLE_KEY"] == f"{mount['mountPath']}/tls.key"
    assert mount["readOnly"] is True
    assert volume["secret"] == {"secretName": "console", "defaultMode": 0o440}
    names = given["EDGEVOX_CONSOLE_NAMES"].split(",")
    assert names == [
        "robots.local",
        "192.168.1.7",
        "fleet-edgevox-a-console.robots.svc",
        "a.example",
    ]


def test_the_recorder_beside_it_has_no_console() -> None:
    recorder = pods(SITE)["a"]["containers"][1]

    assert recorder["name"] == "recorder"
    assert [one["name"] for one in recorder["env"] if "CONSOLE" in one["name"]] == []
    assert {"console", "console-tls"}.isdisjoint(o["name"] for o in recorder["volumeMounts"])


def test_on_the_hosts_network_it_stays_on_loopback() -> None:
    values = ON | {"hostNetwork": True}

    assert environment(pods(values)["solo"])["EDGEVOX_CONSOLE_HOST"] == "127.0.0.1"
    assert console_services(values) == []


def test_a_robots_own_volume_takes_the_place_of_the_common_one() -> None:
    claim = {"persistentVolumeClaim": {"claimName": "a"}}
    robots = [{"name": "a", "domain": 1, "console": {"volume": claim}}, {"name": "b", "domain": 2}]
    common = {"enabled": True, "volume": {"hostPath": {"path": "/srv"}}}
    found = pods({"robots": robots, "console": common})
    volumes = {
        name: next(one for one in pod["volumes"] if one["name"] == "console")
        for name, pod in found.items()
    }

    assert volumes["a"] == {"name": "console", **claim}
    assert volumes["b"] == {"name": "console", "hostPath": {"path": "/srv"}}
