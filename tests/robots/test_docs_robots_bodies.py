"""What docs/robots.md says of each body's state and topics is what the body has."""

import tomllib
from pathlib import Path

import pytest

from edgevox.apps.robots import build_body
from edgevox.core.settings import load_settings
from edgevox.robots import capabilities as can

TOLD = tomllib.loads(
    (Path(__file__).parents[2] / "scripts" / "docs" / "told.toml").read_text("utf-8")
)
TOPICS = {
    "/tf": can.HasPose | can.HasEndEffector,
    "/tf_static": can.HasLidar | can.HasCamera,
    "pose": can.HasPose | can.HasEndEffector,
    "odom": can.HasPose,
    "scan": can.HasLidar,
    "image_raw": can.HasCamera,
    "camera_info": can.HasCamera,
    "picture": can.HasCamera,
    "cmd_vel": can.TakesVelocity,
    "goal_pose": can.DrivesTo | can.HasEndEffector,
}
ENTRIES = {"robot-irsim": "apartment"}
"""The robots that share a part of the page with another one."""
SAME_SKILLS = {"external": "apartment"}


@pytest.fixture(
    params=["robot-apartment", "robot-irsim", "robot-panda", "robot-humanoid", "robot-external"],
    scope="module",
)
def body(request):
    body = build_body(request.param, load_settings({}), 0.0)
    yield body
    body.close()


@pytest.fixture
def entry(body):
    """What its part of the page is called in scripts/docs/told.toml."""
    return ENTRIES.get(body.name, body.name.removeprefix("robot-"))


def test_it_has_the_skills_that_the_page_lists(body, entry):
    told = TOLD["skills"][SAME_SKILLS.get(entry, entry)]
    assert {skill.name for skill in body.skills} == set(told)


def test_its_state_has_the_keys_that_the_page_lists(body, entry):
    told = [key for keys in TOLD["state"][entry] for key in keys.split(", ")]
    assert sorted(told) == sorted(body.state())


def test_it_has_the_topics_that_the_page_lists(body, entry):
    if body.name == "robot-external":  # its topics are those of the robot that is there
        assert entry not in TOLD["topics"]
        return
    topics = {topic for topic, needs in TOPICS.items() if isinstance(body, needs)}
    assert set(TOLD["topics"][entry]) == topics


def test_the_page_says_how_it_is_simulated(body, entry):
    kind = body.state().get("simulation")
    assert kind is None or f'"{kind}"' in TOLD["state"][entry]["simulation"]
