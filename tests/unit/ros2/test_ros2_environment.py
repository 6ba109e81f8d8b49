"""What the environment must say before rclpy is imported, which ends a process without a word."""

import pytest

from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.ros2.external import EXTERNAL
from edgevox.ros2.open import check_environment


@pytest.mark.parametrize(
    ("variable", "value", "expected"),
    [
        ("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp", "one that is installed: rmw_fastrtps_cpp"),
        ("ROS_DOMAIN_ID", "300", "a whole number from 0 to 232"),
        ("ROS_DOMAIN_ID", "abc", "a whole number from 0 to 232"),
    ],
)
def test_what_would_end_the_process_is_refused_by_its_variable(variable, value, expected):
    with pytest.raises(InvalidValue) as refused:
        check_environment({variable: value})
    error = refused.value
    assert (error.field, error.value, error.expected) == (variable, value, expected)


def test_what_is_there_and_what_is_not_set_are_taken():
    check_environment({})
    check_environment({"RMW_IMPLEMENTATION": "rmw_fastrtps_cpp", "ROS_DOMAIN_ID": "7"})
    check_environment({"RMW_IMPLEMENTATION": "", "ROS_DOMAIN_ID": ""})


def test_a_robot_of_ones_own_is_not_built_with_a_middleware_that_is_missing(monkeypatch):
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
    with pytest.raises(InvalidValue, match="RMW_IMPLEMENTATION: got 'rmw_zenoh_cpp'"):
        EXTERNAL.build(Settings(), None)
