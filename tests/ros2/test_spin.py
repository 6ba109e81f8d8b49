"""A thread that runs an executor's callbacks ends when it is asked to, idle or busy."""

import threading

import pytest
from guards import HUNG_S
from rclpy.clock import Clock, ClockType
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from edgevox.ros2.node import end_spin, spin_until

ENDS = 50
"""Without the right order, about one end in a hundred of a busy node failed."""


@pytest.fixture
def context(domain):
    one = Context()
    one.init(domain_id=domain)
    yield one
    one.try_shutdown()


def spun(executor, ended, failures):
    try:
        spin_until(ended, executor)
    except Exception as error:  # noqa: BLE001 - whatever it is, it is a failure
        failures.append(error)


def end_one(context, busy):
    node = Node("spun", context=context, enable_rosout=False, start_parameter_services=False)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    ended, called, failures = threading.Event(), threading.Event(), []
    if busy:
        node.create_timer(1e-6, called.set, clock=Clock(clock_type=ClockType.STEADY_TIME))
    thread = threading.Thread(target=spun, args=(executor, ended, failures), daemon=True)
    thread.start()
    if busy:
        assert called.wait(HUNG_S)
    ending = threading.Thread(target=end_spin, args=(ended, executor, thread), daemon=True)
    ending.start()
    ending.join(HUNG_S)
    hung = ending.is_alive()
    if not hung:
        node.destroy_node()
    return hung, failures


@pytest.mark.parametrize("busy", [False, True])
def test_it_ends(context, busy):
    for _ in range(ENDS):
        assert end_one(context, busy) == (False, [])
