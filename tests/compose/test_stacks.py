"""Whole stacks: the smoke test, a fleet, and every way of networking delivers data."""

import pytest
from guards import HUNG_S
from stacks import PATIENCE, PROBE, Stack, count_messages, stack

pytestmark = pytest.mark.usefixtures("image")
STATE = "/edgevox/robot_state"


def test_the_smoke_stack_is_judged_by_the_recorder_and_leaves_a_recording(tmp_path):
    with stack("smoke", start=False) as smoke:
        up = ("up", "--no-build", "--exit-code-from", "recorder")
        ran = smoke.call(*up, timeout=HUNG_S)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        assert "PASSED" in ran.stdout
        smoke.call("cp", "recorder:/recordings", str(tmp_path))
    counted = count_messages(tmp_path)
    assert counted[STATE] > 30  # ten a second, while it drives
    assert counted["/edgevox/text_input"] == 1
    assert counted["/edgevox/response"] == 2  # that it goes, and that it is there
    assert counted["/edgevox/agent_event"] >= 2
    assert counted["/tf"] > 90


def test_the_smoke_stack_fails_where_the_robot_does_not_do_it(tmp_path):
    never = tmp_path / "smoke.yaml"
    never.write_text(
        "steps:\n  - say: where are you\n  - expect: {answer: on the moon}\n    within: 2\n"
    )
    tmp_path.chmod(0o755)
    with stack("smoke", start=False) as smoke:
        up = smoke.call("up", "--no-build", "--wait", "edgevox-ros2", timeout=HUNG_S)
        assert up.returncode == 0, up.stderr
        judge = ("run", "--rm", "-T", "-v", f"{tmp_path}:/scenarios:ro", "recorder")
        assert smoke.call(*judge, timeout=HUNG_S).returncode == 1


@pytest.fixture(scope="module")
def fleet():
    with stack("fleet", services=("robot1", "robot2"), EDGEVOX_LLM="none") as one:
        yield one


def test_robots_of_a_fleet_do_not_hear_each_other(fleet: Stack):
    heard = fleet.probe("robot1", PATIENCE, "/robot1/robot_state#40", "/robot2/robot_state")
    assert heard["count"]["/robot1/robot_state"] >= 40  # as many as 4 s bring
    assert heard["count"]["/robot2/robot_state"] == 0


def test_it_is_the_domain_that_keeps_them_apart(fleet: Stack):
    listen = f"ROS_DOMAIN_ID=2 python3 - {PATIENCE} /robot2/robot_state"
    heard = fleet.execute("robot1", "bash", "-c", listen, stdin=PROBE)
    assert '"found": {"/robot2/robot_state": true}' in heard


def test_only_the_robot_that_is_spoken_to_drives(fleet: Stack):
    drive = (
        "/robot1/response=Going to the kitchen",
        "--say",
        "/robot1/text_input=go to the kitchen",
    )
    assert all(fleet.probe("robot1", PATIENCE, *drive)["found"].values())
    arrived = fleet.probe("robot1", PATIENCE, '/robot1/robot_state="room": "kitchen"')
    assert all(arrived["found"].values())
    stayed = fleet.probe("robot2", PATIENCE, '/robot2/robot_state#10="room": "kitchen"')
    assert stayed["count"]["/robot2/robot_state"] >= 10
    assert not any(stayed["found"].values())


@pytest.mark.parametrize("overlays", [(), ("host",)], ids=str)
def test_data_arrives_between_containers_in_every_network_that_is_offered(overlays):
    with stack(*overlays, EDGEVOX_LLM="none") as one:
        assert _is_heard_from_beside(one)


@pytest.mark.long
def test_either_discovery_server_may_fail_and_after_it_is_back_the_other():
    with stack("discovery", EDGEVOX_LLM="none", EDGEVOX_PEERS_WAIT_S="1") as one:
        assert _is_heard_from_beside(one)
        assert one.call("kill", "discovery2").returncode == 0
        assert _is_heard_from_beside(one)
        kept = one.probe("edgevox-ros2", PATIENCE, f"{STATE}=room")
        assert kept["found"][STATE]
        again = ("up", "--detach", "--no-build", "--no-recreate", "--wait", "discovery2")
        assert one.call(*again, timeout=HUNG_S).returncode == 0
        assert one.call("kill", "discovery").returncode == 0
        assert _is_heard_from_beside(one)


@pytest.mark.long
@pytest.mark.parametrize("down", ["discovery", "discovery2"])
def test_a_robot_that_starts_while_a_discovery_server_is_down_is_found_by_the_other(down):
    with stack("discovery", start=False, EDGEVOX_LLM="none", EDGEVOX_PEERS_WAIT_S="1") as one:
        up = ("up", "--detach", "--no-build", "--no-deps", "--wait", "edgevox-ros2")
        (other,) = {"discovery", "discovery2"} - {down}
        ran = one.call(*up, other, timeout=HUNG_S)
        assert ran.returncode == 0, ran.stderr
        assert f"no address of {down};" in one.call("logs", "edgevox-ros2").stdout
        assert _is_heard_from_beside(one)


@pytest.mark.long
def test_by_the_discovery_servers_and_by_nothing_else():
    with stack("discovery", EDGEVOX_LLM="none") as one:
        by_multicast = {"ROS_DISCOVERY_SERVER": ""}
        heard = one.probe_from_beside("edgevox-ros2", "5", STATE, given=by_multicast)
        assert not heard["found"][STATE]


def _is_heard_from_beside(one: Stack) -> bool:
    """Whether a new peer, a container of its own, finds the robot."""
    return one.probe_from_beside("edgevox-ros2", PATIENCE, f"{STATE}=room")["found"][STATE]
