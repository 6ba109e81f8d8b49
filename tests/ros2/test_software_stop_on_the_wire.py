"""A stopped robot as other ROS 2 software sees it: it is told, and whatever it asks is refused."""

import json
from contextlib import ExitStack

import phrases
import pytest
from action_rig import Client
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, Twist
from interop_rig import hear, tell, twist
from peer import RELIABLE
from waiting import wait_until

from edgevox.agent.text.reasons import because
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.core.settings import load_settings
from edgevox.robots.flat.apartment import ApartmentRobot

STOPPED = because("software_stop")


@pytest.fixture
def parts(domain, monkeypatch):
    """A whole agent in this process, whose robot's time stands still."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    with ExitStack() as stack:
        settings = load_settings({"text_mode": True, "ros2": True, "llm": "none"})
        built = build_parts(stack, settings, ApartmentRobot(speed=0.0))
        start_parts(stack, built)
        yield built


def standing(parts):
    parts.body.advance(1.0)
    velocity = parts.body.velocity()
    return (velocity.linear_m_s, velocity.angular_rad_s) == pytest.approx((0.0, 0.0))


def test_press_and_release_are_told_and_diagnostics_warn_meanwhile(parts, peer):
    one = peer()
    events = one.listen("agent_event")
    heard = hear(one, DiagnosticArray, "/diagnostics", RELIABLE)

    def wait_for(level):
        def found(message):
            named = (one for one in message.status if one.name.endswith(": interlock"))
            return [one for one in named if one.level == level]

        return found(heard.wait_for(found))[0]

    wait_for(DiagnosticStatus.OK)
    parts.software_stop.stop("a phone")
    stop = {"kind": "software_stop", "engaged": True, "by": "a phone"}
    events.wait_for(lambda m: json.loads(m) == stop)
    assert str(STOPPED) in wait_for(DiagnosticStatus.WARN).message
    parts.software_stop.resume("a tablet")
    events.wait_for(lambda m: json.loads(m) == {**stop, "engaged": False, "by": "a tablet"})


def test_whatever_other_software_asks_is_refused_until_somebody_resumes(parts, peer, caplog):
    one = peer()
    events, response = one.listen("agent_event"), one.listen("response")
    velocity = tell(one, Twist, "/edgevox/cmd_vel")
    goal_pose = tell(one, PoseStamped, "/edgevox/goal_pose")
    client = Client(one)
    parts.software_stop.stop("a phone")

    velocity(twist(0.4, 0.0))
    wait_until(lambda: "velocity_refused" in caplog.text, "cmd_vel is refused")
    goal = PoseStamped()
    goal.header.frame_id, goal.pose.position.x, goal.pose.position.y = "map", 3.0, 3.0
    goal_pose(goal)
    wait_until(lambda: "goal_pose_refused" in caplog.text, "goal_pose is refused")
    assert not client.send("navigate_to", room="kitchen").accepted
    rejected = json.loads(events.wait_for(lambda m: "rejected" in m))
    assert (rejected["code"], rejected["error"]) == (STOPPED.code, str(STOPPED))
    one.send("text_input", "go to the kitchen")
    response.wait_for(lambda m: m == phrases.refused("software_stop"))
    assert standing(parts)

    parts.software_stop.resume("a phone")
    assert standing(parts)
    # Until its queue was empty once, a goal may have waited since the stop, and is refused.
    wait_until(lambda: client.send("navigate_to", room="kitchen").accepted, "a goal counts again")
