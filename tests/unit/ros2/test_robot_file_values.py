"""Values between people and messages: constants, conversions, items of lists, and failures."""

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import BatteryState, JointState
from std_msgs.msg import Int32
from trajectory_msgs.msg import JointTrajectoryPoint

from edgevox.agent.phrases.load import phrasebook
from edgevox.core.errors import InvalidValue
from edgevox.core.reason import Reason
from edgevox.ros2.clients import interface_reason
from edgevox.ros2.robot_file.arguments import failure_of, meanings
from edgevox.ros2.robot_file.format import Argument, SkillEntry
from edgevox.ros2.robot_file.live import holds, progress_of, value_of
from edgevox.ros2.robot_file.messages import Filling
from edgevox.ros2.robot_file.steps import FieldCondition, Progress, ResultValue
from tf2_msgs.msg import TFMessage

FILLING = Filling(Time)
JOINTS = JointState(name=["shoulder", "elbow"], position=[0.5, 1.25])


def test_a_field_takes_the_name_of_a_constant():
    request = {"power_supply_status": "{status}", "power_supply_health": "POWER_SUPPLY_HEALTH_DEAD"}
    status = {"status": "POWER_SUPPLY_STATUS_FULL"}
    filled = FILLING.fill(BatteryState(), request, status)
    assert filled.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_FULL
    assert filled.power_supply_health == BatteryState.POWER_SUPPLY_HEALTH_DEAD
    with pytest.raises(InvalidValue, match="POWER_SUPPLY_STATUS_FULL"):
        FILLING.fill(BatteryState(), {"power_supply_status": "FULL"}, {})
    assert FILLING.fill(BatteryState(), {"location": "FULL"}, {}).location == "FULL"


def test_a_condition_takes_the_name_of_a_constant():
    full = BatteryState(power_supply_status=BatteryState.POWER_SUPPLY_STATUS_FULL)
    condition = FieldCondition(field="power_supply_status", equals="POWER_SUPPLY_STATUS_FULL")
    assert holds(full, [condition], {})
    assert not holds(BatteryState(), [condition], {})


@pytest.mark.parametrize(
    ("how", "said", "sent"),
    [
        ({"times": 60}, 3, 180),
        ({"times": 0.1}, 3, 0),
        ({"times": -8, "plus": 800}, 25, 600),
        ({"plus": 1}, 3, 4),
    ],
)
def test_a_converted_number_is_whole_where_the_field_is(how, said, sent):
    arguments = {"x": Argument(type="integer", min=0, max=100, **how)}
    values = meanings(arguments, {"x": said})
    assert FILLING.fill(Int32(), {"data": "{x}"}, values).data == sent


def test_a_number_that_nobody_converts_is_refused_where_the_field_is_whole():
    with pytest.raises(InvalidValue, match="whole number"):
        FILLING.fill(Int32(), {"data": "{x}"}, {"x": 2.5})


def test_a_converted_number_in_a_text_is_written_as_people_write_it():
    values = meanings({"x": Argument(type="integer", times=60)}, {"x": 3})
    assert (
        Filling(Time).fill(BatteryState(), {"location": "in {x} s"}, values).location == "in 180 s"
    )


def test_a_duration_takes_seconds():
    filled = FILLING.fill(JointTrajectoryPoint(), {"time_from_start": "{x}"}, {"x": 2.5})
    assert (filled.time_from_start.sec, filled.time_from_start.nanosec) == (2, 500_000_000)


@pytest.mark.parametrize(
    ("how", "value"),
    [
        ({"field": "position[name=elbow]"}, 1.25),
        ({"field": "position[name={joint}]"}, 0.5),
        ({"field": "position[name=wrist]"}, None),
        ({"field": "position[5]"}, None),
        ({"field": "position[1]", "times": 2, "plus": 1, "decimals": 1}, 3.5),
        ({"field": "name"}, ["shoulder", "elbow"]),
        ({"field": "name", "count": True}, 2),
        ({"field": "velocity", "count": True}, 0),
    ],
)
def test_an_item_is_found_by_its_name_and_a_list_is_counted(how, value):
    assert value_of(JOINTS, ResultValue(**how), {"joint": "shoulder"}) == value


def test_a_field_of_each_item_is_a_list_and_an_item_is_found_by_a_field_of_its_own():
    frames = TFMessage(transforms=[transform("arm", 1.0), transform("hand", 2.0)])
    assert value_of(frames, ResultValue(field="transforms[].child_frame_id")) == ["arm", "hand"]
    hand = "transforms[child_frame_id=hand].transform.translation.x"
    assert value_of(frames, ResultValue(field=hand)) == 2.0


def transform(name, x):
    one = TransformStamped(child_frame_id=name)
    one.transform.translation.x = x
    return one


@pytest.mark.parametrize(
    ("how", "values", "parts"),
    [
        ({}, [0.0, 0.35, 1.0, 2.0], [0.0, 0.35, 1.0, None]),
        ({"of": 100.0}, [0.0, 35.0], [0.0, 0.35]),
        ({"down": True}, [8.0, 6.0, 0.0], [0.0, 0.25, 1.0]),
        ({"down": True, "of": 10.0}, [8.0, 5.0], [0.2, 0.5]),
        ({"of": "voltage"}, [1.0, 3.0], [0.25, 0.75]),
        ({"times": 0.5, "plus": 0.1}, [1.0], [0.6]),
    ],
)
def test_feedback_counts_up_or_down_of_a_number_or_of_a_field(how, values, parts):
    part = progress_of(Progress(field="percentage", **how))
    assert [part(BatteryState(percentage=one, voltage=4.0)) for one in values] == pytest.approx(
        parts
    )


def entry(failed, **more):
    call = {"name": "dock", "type": "std_srvs/srv/Trigger"}
    return SkillEntry.model_validate(
        {"description": "Dock.", "call": call, "failed": failed, **more}
    )


def test_the_robots_own_reason_is_said_and_nothing_stands_before_it():
    reason = failure_of(entry("The base says: {why}."), Reason("x", "refused"), {"why": "no dock."})
    assert str(reason) == "The base says: no dock."
    assert phrasebook("en").failure(reason) == "The base says: no dock."
    assert phrasebook("de").failure(reason) == "The base says: no dock."
    bare = failure_of(entry("The base says: {why}"), Reason("x", "refused"), {"why": "no dock"})
    assert phrasebook("en").failure(bare) == "The base says: no dock."


def test_a_failure_is_told_by_the_usual_reason_where_the_robot_gives_none():
    usual = interface_reason("not_there", what="dock")
    assert failure_of(entry("The base says: {why}."), usual, {}) is usual
    assert failure_of(entry("The base says: {why}."), usual, {"why": ""}) is usual


def test_a_failure_has_the_usual_reason_in_it_and_words_in_each_language():
    german = {
        "failed": "Nicht angedockt: {reason}, {docked}.",
        "words": {"docked": {"false": "fern"}},
    }
    one = entry(
        "Not docked: {reason}, {docked}.",
        words={"docked": {"false": "far"}},
        languages={"de": german},
    )
    reason = failure_of(one, interface_reason("refused", what="dock"), {"docked": False})
    assert phrasebook("en").failure(reason) == "Not docked: the robot refused that, far."
    told = "Nicht angedockt: der Roboter hat das abgelehnt, fern."
    assert phrasebook("de").failure(reason) == told
