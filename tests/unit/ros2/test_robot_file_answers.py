"""What a robot's interfaces answer, whatever they answer, costs a skill and a stop no time."""

import json
import time

import pytest
from geometry_msgs.msg import PoseWithCovariance
from std_msgs.msg import Float64, String, UInt8MultiArray
from support.clock import HeldClock

from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.ros2.clients import Newest, TookTooLong
from edgevox.ros2.robot_file.live import value_of
from edgevox.ros2.robot_file.paths import LONGEST_SHOWN, LONGEST_TEXT, brief
from edgevox.ros2.robot_file.steps import ResultValue

MOMENT_S = 0.2
BIG = UInt8MultiArray(data=bytes(10_000_000))


def test_ten_megabytes_that_are_told_keep_no_thread_from_a_stop():
    begun_s = time.perf_counter()
    told = [value_of(BIG, ResultValue(field="data")), brief(BIG)]
    assert time.perf_counter() - begun_s < MOMENT_S
    assert told[0] == [0] * LONGEST_SHOWN
    assert json.dumps(told)
    assert len(value_of(String(data="x" * 10_000_000), ResultValue(field="data"))) == LONGEST_TEXT


@pytest.mark.parametrize("decimals", [0, 3])
@pytest.mark.parametrize("number", [float("nan"), float("inf"), -float("inf"), 1e308])
def test_a_number_that_is_none_is_no_result_and_breaks_no_skill(number, decimals):
    how = ResultValue(field="data", times=1e10, decimals=decimals)
    assert value_of(Float64(data=number), how) is None


def test_a_list_of_a_fixed_length_is_a_result_as_json_has_it():
    assert value_of(PoseWithCovariance(), ResultValue(field="covariance")) == [0.0] * 36


def flooded(newest, then):
    """What never fits, and brings the next message with it."""

    def fits(_):
        newest.take("another")
        then()
        return False

    newest.take("first")
    return fits


def test_a_flood_of_messages_that_do_not_fit_keeps_nobody_from_a_stop():
    newest, token = Newest(HeldClock()), CancelToken()
    fits = flooded(newest, lambda: token.cancel("stop"))
    with pytest.raises(Cancelled):
        newest.wait(fits, token, 10.0, lambda: ("first",))


def test_a_flood_of_messages_that_do_not_fit_lasts_no_longer_than_its_time():
    clock = HeldClock()
    newest = Newest(clock)

    def pass_by():
        clock.now_s += 1.0

    fits = flooded(newest, pass_by)
    with pytest.raises(TookTooLong):
        newest.wait(fits, CancelToken(), 10.0, lambda: ("first",))
