"""The doctor's judgement of ROS 2 and the network below it, from plain values."""

import pytest
from doctor_rig import ERROR, OK, SKIPPED, WARNING, levels, situation

from edgevox.apps.doctor import ros

RCLPY = {"missing": "", "failed": "", "middleware": "rmw_fastrtps_cpp", "installed": []}


@pytest.mark.parametrize(
    ("changed", "settings", "level"),
    [
        ({}, {}, OK),
        ({"missing": "no module rclpy"}, {}, SKIPPED),
        ({"missing": "no module rclpy"}, {"ros2": True}, ERROR),
        ({"failed": "librmw_x.so"}, {}, ERROR),
    ],
)
def test_a_middleware_must_load_and_ros2_be_there_if_it_is_asked_for(changed, settings, level):
    assert ros.judge_middleware(RCLPY | changed, situation(**settings)).level is level


def test_interfaces_that_are_not_built_are_named():
    said = ros.judge_interfaces({"missing": ["edgevox_msgs.action"]}, situation())
    assert (said.level, "edgevox_msgs" in said.found) == (WARNING, True)
    assert ros.judge_interfaces({"missing": []}, situation()).level is OK


@pytest.mark.parametrize(
    ("domain", "level"),
    [
        ("", OK),
        ("0", OK),
        ("42", OK),
        ("150", WARNING),
        ("230", OK),
        ("233", ERROR),
        ("-1", ERROR),
        ("abc", ERROR),
        ("４", ERROR),
    ],
)
def test_a_domain_must_be_a_number_whose_ports_are_free(domain, level):
    facts = {"domain": domain, "low": 32768, "high": 60999}
    assert ros.judge_domain(facts, situation()).level is level


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, [OK]),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, [OK]),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "NEAR"}, [ERROR]),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, [WARNING]),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_STATIC_PEERS": "10.0.0.2"}, [OK]),
        ({"ROS_STATIC_PEERS": "127.0.0.1;nobody.invalid"}, [ERROR]),
        ({"ROS_DISCOVERY_SERVER": ";127.0.0.1:11812"}, [OK]),
        ({"ROS_DISCOVERY_SERVER": "nobody.invalid:11811;127.0.0.1:11812"}, [ERROR]),
        ({"ROS_LOCALHOST_ONLY": "1"}, [WARNING]),
    ],
)
def test_discovery_must_be_in_words_that_exist(environment, expected):
    here = situation(environment=environment)
    assert levels(ros.judge_discovery(ros.probe_discovery(here), here)) == expected


@pytest.mark.parametrize(
    ("trip_ms", "environment", "level"),
    [
        (1.2, {}, OK),
        (500.0, {}, WARNING),
        (None, {}, ERROR),
        (None, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, WARNING),
    ],
)
def test_a_message_must_come_back(trip_ms, environment, level):
    facts = {"met_s": 0.4, "trip_ms": trip_ms, "tried_s": 10.0}
    assert ros.judge_round_trip(facts, situation(environment=environment)).level is level


@pytest.mark.parametrize(
    ("interfaces", "level"),
    [
        ({"lo 127.0.0.1": "", "eth0 10.0.0.2": ""}, OK),
        ({"lo 127.0.0.1": ""}, OK),
        ({"lo 127.0.0.1": "", "eth0 10.0.0.2": "nothing is heard"}, WARNING),
        ({"eth0 10.0.0.2": "nothing is heard", "wlan0 10.1.0.2": ""}, OK),
    ],
)
def test_multicast_must_work_on_a_network_if_there_is_one(interfaces, level):
    assert ros.judge_multicast({"interfaces": interfaces}, situation()).level is level


SHM = {"there": True, "writable": True, "size_mib": 256, "free_mib": 200}
SHM |= {"stale": 0, "stale_mib": 0}


@pytest.mark.parametrize(
    ("changed", "level"),
    [
        ({}, OK),
        ({"there": False}, WARNING),
        ({"writable": False}, WARNING),
        ({"free_mib": 0}, ERROR),
        ({"stale": 200, "stale_mib": 100}, WARNING),
        ({"stale": 2, "stale_mib": 1}, OK),
        ({"size_mib": 32}, WARNING),
    ],
)
def test_shared_memory_must_be_large_and_free(changed, level):
    assert ros.judge_shared_memory(SHM | changed, situation()).level is level


def test_a_segment_is_stale_once_nobody_holds_its_lock(tmp_path, monkeypatch):
    import fcntl

    monkeypatch.setattr(ros, "SHM", tmp_path)
    (tmp_path / "fastrtps_0123").write_bytes(b"x" * 3 * 2**20)
    with (tmp_path / "fastrtps_0123_el").open("wb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert ros.probe_shared_memory(situation())["stale"] == 0
    facts = ros.probe_shared_memory(situation())
    assert (facts["stale"], facts["stale_mib"]) == (1, 3)


@pytest.mark.parametrize("most", [None, 212992, 4 * 2**20])
def test_small_buffers_are_a_hint_and_no_fault(most):
    said = ros.judge_buffers({"rmem_max": most}, situation())
    assert said.level is OK
    assert bool(said.advice) == (most == 212992)
