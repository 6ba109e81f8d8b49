"""One robot's container: what runs in it, what it may, and how it ends."""

import signal

import pytest
from guards import HUNG_S
from stacks import PATIENCE, Stack, stack
from waiting import wait_until

from edgevox.apps.run_program import STUCK

pytestmark = pytest.mark.usefixtures("image")
SERVICE = "edgevox-ros2"
ROBOT_STATE = "/edgevox/robot_state"
# What /proc says of every process: name, real uid, capability sets, and whether it may gain any.
STATUS = r"""
for status in /proc/[0-9]*/status; do
    awk '/^(Name|Uid|Cap...|NoNewPrivs):/ { printf "%s=%s ", $1, $2 } END { print "" }' $status
done
"""
SIGNAL_AGENT = r"""
for name in $(grep -lx edgevox-agent /proc/[0-9]*/comm); do
    kill -"$0" "$(basename "${name%/comm}")"
done
"""


@pytest.fixture(scope="module")
def robot():
    with stack() as one:
        yield one


@pytest.fixture(scope="module")
def unstarted():
    with stack(start=False) as one:
        yield one


def test_with_nothing_configured_a_robot_is_on_the_wire(robot: Stack):
    assert robot.inspect(SERVICE)["State"]["Health"]["Status"] == "healthy"
    assert robot.probe(SERVICE, PATIENCE, f"{ROBOT_STATE}=room")["found"][ROBOT_STATE]


def test_no_process_is_root_or_has_or_can_gain_a_capability(robot: Stack):
    lines = robot.execute(SERVICE, "bash", "-c", STATUS).splitlines()
    processes = [dict(pair.split("=") for pair in line.split()) for line in lines if line.strip()]
    assert {"edgevox-agent"} <= {one["Name:"][:13] for one in processes}
    for one in processes:
        assert int(one["Uid:"]) == 1000, one
        assert one["NoNewPrivs:"] == "1", one
        sets = [int(one[f"Cap{name}:"], 16) for name in ("Inh", "Prm", "Eff", "Bnd", "Amb")]
        assert not any(sets), one


@pytest.mark.parametrize("place", ["/", "/etc", "/opt/edgevox", "/opt/edgevox/models", "/home"])
def test_nothing_can_be_written_but_in_memory(robot: Stack, place):
    wrote = robot.call("exec", "-T", SERVICE, "touch", f"{place}/mark")
    assert wrote.returncode != 0
    assert "Read-only file system" in wrote.stderr
    assert robot.call("exec", "-T", SERVICE, "bash", "-c", "touch ~/mark").returncode == 0


@pytest.mark.parametrize("name", ["KILL", "STOP"], ids=["killed", "frozen"])
def test_a_robot_that_is_killed_or_frozen_comes_back_by_itself(robot: Stack, name):
    before = robot.inspect(SERVICE)
    seen = ("exec", "-T", SERVICE, "test", "-e", "/tmp/edgevox-health-frozen")  # noqa: S108
    wait_until(lambda: robot.call(*seen).returncode == 0, "a health check that passed")
    robot.call("exec", "-T", SERVICE, "bash", "-c", SIGNAL_AGENT, name)

    def is_back() -> bool:
        now = robot.inspect(SERVICE)
        restarted = now["RestartCount"] == before["RestartCount"] + 1
        return restarted and now["State"].get("Health", {}).get("Status") == "healthy"

    wait_until(is_back, "restarted and healthy")
    assert robot.probe(SERVICE, PATIENCE, f"{ROBOT_STATE}=room")["found"][ROBOT_STATE]


BEFORE_A_HANDLER = 128 + signal.SIGTERM


def ends(robot: Stack) -> int:
    """Its exit code after `docker stop`; 0 for one that a busy machine kept, and which said so."""
    robot.call("stop", "--timeout", str(HUNG_S), SERVICE)
    code = robot.inspect(SERVICE)["State"]["ExitCode"]
    return 0 if code == STUCK and "leaving_late" in robot.logs(SERVICE) else code


def test_docker_stop_ends_it_cleanly(robot: Stack):
    assert ends(robot) == 0


def test_docker_stop_ends_it_cleanly_while_it_starts(robot: Stack):
    robot.call("stop", SERVICE)
    robot.call("start", SERVICE)
    assert ends(robot) in (0, BEFORE_A_HANDLER)


def test_a_command_runs_with_ros_2_edgevox_and_the_interfaces_at_hand(unstarted: Stack):
    command = 'python3 -c "import rclpy, edgevox_msgs.action; print(rclpy)" && edgevox --version'
    ran = unstarted.call("run", "--rm", "-T", SERVICE, "bash", "-c", command, timeout=HUNG_S)
    assert ran.returncode == 0, ran.stderr
    assert "<module 'rclpy'" in ran.stdout


def test_what_it_keeps_goes_to_another_one(unstarted: Stack):
    script = """
    set -e
    echo 'places: {}' >/places/robot-apartment.yaml
    edgevox state export - >/tmp/robot.tar
    rm /places/robot-apartment.yaml
    edgevox state import - </tmp/robot.tar >&2
    cat /places/robot-apartment.yaml
    """
    ran = unstarted.call("run", "--rm", "-T", SERVICE, "bash", "-c", script, timeout=HUNG_S)
    assert (ran.returncode, ran.stdout) == (0, "places: {}\n"), ran.stderr


@pytest.mark.long
def test_the_doctor_finds_no_fault_in_the_container(unstarted: Stack):
    ran = unstarted.call("run", "--rm", "-T", SERVICE, "edgevox", "doctor", timeout=HUNG_S)
    assert ran.returncode == 0, ran.stdout
    assert "uid 1000, read-only root file system" in ran.stdout
    assert "two nodes met" in ran.stdout


def test_the_exit_code_of_a_command_is_the_containers(unstarted: Stack):
    assert unstarted.call("run", "--rm", "-T", SERVICE, "bash", "-c", "exit 7").returncode == 7


def test_a_shell_by_exec_has_the_same_environment(robot: Stack):
    robot.call("start", SERVICE)
    asked = (
        "echo $ROS_DISTRO; command -v edgevox-agent; python3 -c 'import rclpy, edgevox_msgs.action'"
    )
    for shell in (("bash", "-c"), ("bash", "-lc"), ("bash", "-euo", "pipefail", "-c")):
        assert robot.execute(SERVICE, *shell, asked) == "jazzy\n/opt/edgevox/bin/edgevox-agent\n"


@pytest.mark.parametrize(
    ("variable", "line"),
    [
        ("ROS_DOMAIN_ID=300", "edgevox: ROS_DOMAIN_ID: got '300', expected a whole number from 0"),
        ("EDGEVOX_NAMESPACE=a b", "edgevox: EDGEVOX_NAMESPACE: got 'a b', expected a ROS 2 names"),
        ("EDGEVOX_AGENT=robot-x", "edgevox: EDGEVOX_AGENT: got 'robot-x', expected one of robot-"),
    ],
)
def test_nonsense_in_the_environment_stops_it_before_anything_starts(
    unstarted: Stack, variable, line
):
    ran = unstarted.call("run", "--rm", "-T", "-e", variable, SERVICE, timeout=HUNG_S)
    assert ran.returncode == 64
    said = [one for one in ran.stderr.splitlines() if one.startswith("edgevox")]
    assert len(said) == 1
    assert said[0].startswith(line)
    assert not ran.stdout


def test_process_1_forwards_signals_and_reaps(unstarted: Stack):
    """Orphans of a command are taken over by process 1; none stays behind as a zombie."""
    orphan = "(sleep 0.2 &) ; sleep 1; grep -l '^State:.Z' /proc/[0-9]*/status || echo none"
    ran = unstarted.call("run", "--rm", "-T", SERVICE, "bash", "-c", orphan, timeout=HUNG_S)
    assert ran.stdout.strip() == "none", ran.stdout
