"""What Pod Security's "restricted" does not admit is said in values and notes."""

import pytest
from chart_rig import chart

ADMITTED = {"persistentVolumeClaim": {"claimName": "x"}}
HOST_PATH = {"hostPath": {"path": "/srv"}}


def notes(**robot) -> str:
    values = {"robots": [{"name": "solo", "domain": 7, **robot}]}
    return chart.render(values)["edgevox/templates/NOTES.txt"]


@pytest.mark.parametrize(
    ("robot", "named"),
    [
        ({"hostNetwork": True}, "hostNetwork"),
        ({"models": {"volume": HOST_PATH}}, "models.volume"),
        ({"places": {"volume": {"nfs": {"server": "a", "path": "/b"}}}}, "places.volume"),
        ({"plugins": {"volume": HOST_PATH}}, "plugins.volume"),
        ({"recorder": {"enabled": True, "volume": HOST_PATH}}, "recorder.volume"),
        ({"extraVolumes": [{"name": "x", **HOST_PATH}]}, "extraVolumes"),
        ({"hostNetwork": True, "models": {"volume": HOST_PATH}}, "hostNetwork, models.volume"),
    ],
)
def test_what_restricted_does_not_admit_is_said_with_what_to_do(robot, named: str) -> None:
    said = notes(**robot)

    assert f'"restricted" does not admit its {named}. If no pod comes:' in said
    assert "kubectl label namespace robots --overwrite" in said


def test_of_what_restricted_admits_nothing_is_said() -> None:
    volumes = {name: {"volume": ADMITTED} for name in ("models", "places", "plugins", "recorder")}
    more = {"extraVolumes": [{"name": "x", "emptyDir": {}}]}
    unused = {"recorder": {"volume": HOST_PATH}}
    for robot in ({}, volumes | more, unused):
        assert "restricted" not in notes(**robot)


@pytest.mark.parametrize("value", ["hostNetwork:", "  volume:", "extraVolumes:"])
def test_each_value_that_restricted_may_not_admit_says_so_above(value: str) -> None:
    lines = (chart.CHART / "values.yaml").read_text().splitlines()
    found = [index for index, line in enumerate(lines) if line.startswith(value)]

    assert found
    for index in found:
        comment = []
        while lines[(index := index - 1)].lstrip().startswith("#"):
            comment.append(lines[index])
        assert any("Not restricted" in line for line in comment), lines[index + 1]
