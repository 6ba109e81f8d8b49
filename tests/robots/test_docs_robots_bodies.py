"""What docs/robots.md says of each body's state and topics is what the body has."""

import re
from pathlib import Path

import pytest

from edgevox.apps.robots import build_body
from edgevox.core.settings import load_settings
from edgevox.robots import capabilities as can

PAGE = (Path(__file__).parents[2] / "docs" / "robots.md").read_text()
TOPICS = {
    "/tf": can.HasPose | can.HasEndEffector,
    "/tf_static": can.HasLidar | can.HasCamera,
    "pose": can.HasPose | can.HasEndEffector,
    "odom": can.HasPose,
    "scan": can.HasLidar,
    "image_raw": can.HasCamera,
    "camera_info": can.HasCamera,
    "cmd_vel": can.TakesVelocity,
    "goal_pose": can.DrivesTo | can.HasEndEffector,
}


@pytest.fixture(
    params=["robot-apartment", "robot-irsim", "robot-panda", "robot-humanoid", "robot-external"],
    scope="module",
)
def told(request):
    """A body, and its section of the page."""
    body = build_body(request.param, load_settings({}), 0.0)
    yield body, re.search(rf"^## [^\n]*{body.name}.*?(?=^## )", PAGE, re.MULTILINE | re.DOTALL)[0]
    body.close()


def test_its_state_has_the_keys_that_the_page_lists(told):
    body, section = told
    table = section.partition("| `robot_state` | what |")[2].partition("\n\n")[0]
    first_cells = "".join(re.findall(r"^\| (.*?) \|", table, re.MULTILINE))
    assert sorted(re.findall(r"`(\w+)`", first_cells)) == sorted(body.state())


def test_it_has_the_topics_that_the_page_lists(told):
    body, section = told
    if body.name == "robot-external":  # its topics are those of the robot that is there
        assert "On ROS 2: " not in section
        return
    listed = re.search(r"^On ROS 2: (.*?)\.(?: |\n)", section, re.MULTILINE | re.DOTALL)[1]
    names = {name for name in re.findall(r"`([\w/]+)`", listed) if name in TOPICS}
    assert names == {topic for topic, needs in TOPICS.items() if isinstance(body, needs)}


def test_the_page_says_how_it_is_simulated(told):
    body, section = told
    kind = body.state().get("simulation")
    assert kind is None or f'"{kind}"' in section
