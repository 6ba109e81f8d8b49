"""What a peer asks of a mobile body: velocities and goals."""

import math

import pytest
from geometry_msgs.msg import PoseStamped, Twist
from interop_rig import HALL, Stream, hear, offer, tell, twist
from peer import RELIABLE, SENSOR
from waiting import wait_until

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet
from edgevox.core.agent_events import AgentEvent, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import RunSkill
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.world.load import parse_world

__all__ = ["offer"]

STEP_S = 0.02
CMD_VEL, GOAL_POSE, POSE = "/edgevox/cmd_vel", "/edgevox/goal_pose", "/edgevox/pose"


@pytest.fixture
def hall(offer):
    return offer(ApartmentRobot(parse_world(HALL, "hall.yaml")), frame_prefix="robot1/")


def goal(frame, x, y, z=0.0, stamp=None):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
    if stamp is not None:
        message.header.stamp = stamp
    return message


def turned(z, w):
    """A goal whose orientation is this quaternion."""
    message = goal("map", 2.0, 2.0)
    message.pose.orientation.z, message.pose.orientation.w = z, w
    return message


def refused(robot, topic):
    """How many messages on a topic were refused, for whatever reason."""
    counts = robot.interop.refusals.items()
    return sum(count for (name, _), count in counts if topic.endswith(f"/{name}"))


def speed(robot):
    return abs(robot.body.velocity().linear_m_s)


@pytest.mark.parametrize("qos", [RELIABLE, SENSOR])
def test_a_velocity_moves_the_robot_whatever_its_qos(hall, peer, qos):
    stream = Stream(tell(peer(), Twist, CMD_VEL, qos), twist(0.4, 0.0))
    wait_until(lambda: hall.body.velocity().linear_m_s == pytest.approx(0.4, abs=0.01), "0.4 m/s")
    stream.end()


def test_a_stream_that_stops_halts_the_robot_after_half_a_second(offer, peer):
    robot = offer(ApartmentRobot(parse_world(HALL, "hall.yaml"), speed=0.0))
    say = tell(peer(), Twist, CMD_VEL)

    def drives():
        say(twist(0.3, 0.0))
        robot.body.advance(STEP_S)
        return speed(robot) > 0.0

    wait_until(drives, "driving")
    say(twist(math.nan, 0.0))
    wait_until(lambda: refused(robot, CMD_VEL), "all that was said before that, too")
    heard_s = robot.body.time_s
    while robot.body.time_s < heard_s + 0.5 - 2 * STEP_S:
        robot.body.advance(STEP_S)
        assert speed(robot) > 0.0
    robot.body.advance(0.4)
    assert speed(robot) < 1e-9


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_none_never_reaches_the_wheels(hall, peer, bad):
    say = tell(peer(), Twist, CMD_VEL)
    stream = Stream(say, twist(0.3, 0.0))
    wait_until(lambda: speed(hall) > 0.25, "driving")
    stream.end()
    poison = Stream(say, twist(bad, 0.0))
    wait_until(lambda: refused(hall, CMD_VEL) > 3, "refusals")
    wait_until(lambda: speed(hall) < 0.01, "standing in spite of the stream")
    poison.end()
    again = Stream(say, twist(0.3, 0.0))
    wait_until(lambda: speed(hall) > 0.25, "driving again")
    again.end()


def test_a_message_with_a_nan_in_a_number_that_is_not_used_is_refused_too(hall, peer):
    broken = twist(0.3, 0.0)
    broken.linear.z = math.nan
    tell(peer(), Twist, CMD_VEL)(broken)
    wait_until(lambda: refused(hall, CMD_VEL) == 1, "a refusal")
    assert speed(hall) < 0.01


def test_more_than_the_limits_is_clamped(hall, peer):
    stream = Stream(tell(peer(), Twist, CMD_VEL), twist(1e30, 0.0))
    wait_until(lambda: speed(hall) > 0.75, "full speed")
    stream.end()
    assert speed(hall) < 0.81
    assert not refused(hall, CMD_VEL)


@pytest.mark.parametrize("linear", [0.2, 0.0])
def test_any_velocity_pre_empts_a_driving_goal_which_ends_as_cancelled(hall, peer, linear):
    bus, ends = Bus(), []
    bus.subscribe(AgentEvent, lambda e: ends.append((str(e.kind), as_json(e).get("status"))))
    agent = Agent(hall.body.name, "", SkillSet(hall.body.skills))
    conversation = Conversation([agent], bus, halt=hall.body.halt)
    conversation.start()
    try:
        conversation.submit(RunSkill("navigate_xy", {"x": 7.0, "y": 2.0}))
        wait_until(lambda: speed(hall) > 0.3, "driving")
        tell(peer(), Twist, CMD_VEL)(twist(linear, 0.0))
        wait_until(lambda: ("skill_cancelled", "cancelled") in ends, "the end of the goal")
        wait_until(lambda: speed(hall) < 0.01, "standing")
    finally:
        conversation.close()


def test_a_goal_on_the_map_asks_for_the_skill_and_its_height_does_not_matter(hall, peer):
    tell(peer(), PoseStamped, GOAL_POSE)(goal("map", 3.0, 1.5, z=9.0))
    assert hall.asked.wait_for(lambda m: True) == ("navigate_xy", {"x": 3.0, "y": 1.5})


@pytest.mark.parametrize("frame", ["base_link", "robot1/base_link"])
def test_a_goal_in_the_robots_frame_is_transformed(hall, peer, frame):
    one = peer()
    hear(one, PoseStamped, POSE).wait_for(lambda m: True)
    tell(one, PoseStamped, GOAL_POSE)(goal(frame, 2.0, 1.0))
    name, point = hall.asked.wait_for(lambda m: True)
    assert name == "navigate_xy"
    assert point == {
        "x": pytest.approx(1 + 2 * math.cos(0.5) - math.sin(0.5), abs=1e-6),
        "y": pytest.approx(2 + 2 * math.sin(0.5) + math.cos(0.5), abs=1e-6),
    }


def test_a_goal_in_the_robots_frame_means_where_it_was_at_the_goals_stamp(hall, peer):
    one = peer()
    then = hear(one, PoseStamped, POSE).wait_for(lambda m: True).header.stamp
    stream = Stream(tell(one, Twist, CMD_VEL), twist(0.8, 0.0))
    wait_until(lambda: hall.body.pose().x_m > 1.5, "having moved")
    stream.end()
    tell(one, PoseStamped, GOAL_POSE)(goal("base_link", 0.0, 0.0, stamp=then))
    _, point = hall.asked.wait_for(lambda m: True)
    assert point == {"x": pytest.approx(1.0, abs=0.05), "y": pytest.approx(2.0, abs=0.05)}


@pytest.mark.parametrize(
    "bad",
    [
        goal("", 2.0, 2.0),
        goal("robot2/base_link", 2.0, 2.0),
        goal("odom", 2.0, 2.0),
        goal("map", math.nan, 2.0),
        goal("map", 2.0, math.inf),
        turned(0.0, 2.0),
        turned(1e308, 1e308),
        turned(0.0, 0.0),
        turned(math.nan, 1.0),
    ],
    ids=[
        "no frame",
        "another robot",
        "no such frame",
        "nan",
        "inf",
        "a quaternion too long",
        "a quaternion without bounds",
        "a quaternion of zeros",
        "an orientation that is no number",
    ],
)
def test_a_goal_that_could_be_misread_is_refused(hall, peer, bad):
    one = peer()
    hear(one, PoseStamped, POSE).wait_for(lambda m: True)
    say = tell(one, PoseStamped, GOAL_POSE)
    say(bad)
    wait_until(lambda: refused(hall, GOAL_POSE) == 1, "a refusal")
    say(goal("map", 3.0, 1.5))
    assert hall.asked.wait_for(lambda m: True) == ("navigate_xy", {"x": 3.0, "y": 1.5})
    assert len(hall.asked.messages) == 1


def test_a_goal_of_a_time_that_is_not_remembered_is_refused(hall, peer):
    one = peer()
    now = hear(one, PoseStamped, POSE).wait_for(lambda m: True).header.stamp
    now.sec -= 3600
    tell(one, PoseStamped, GOAL_POSE)(goal("base_link", 1.0, 0.0, stamp=now))
    wait_until(lambda: refused(hall, GOAL_POSE) == 1, "a refusal")
    assert not hall.asked.messages
