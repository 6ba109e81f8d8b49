"""The runbook of docs/operations.md: its commands, on stacks that have what it is for."""

import pytest
from guards import HUNG_S
from stacks import stack
from waiting import wait_until

pytestmark = [pytest.mark.long, pytest.mark.usefixtures("image")]

QUIET = {"EDGEVOX_LLM": "none"}


def test_why_a_robot_does_not_start_is_in_its_state_and_its_last_line():
    with stack(start=False, ROS_DOMAIN_ID="300", **QUIET) as one:
        one.call("up", "--detach", "--no-build", timeout=HUNG_S)
        wait_until(lambda: "Restarting (64)" in one.call("ps", "--all").stdout, "its state")
        lines = one.call("logs", "--no-log-prefix", "--tail", "9", "edgevox-ros2").stdout
        assert "ROS_DOMAIN_ID: got '300', expected a whole number" in lines.splitlines()[-1]


def test_a_recording_that_a_kill_left_open_is_found_mended_and_copied(tmp_path):
    with stack("recorder", **QUIET) as one:
        asked = ("run", "--rm", "--no-deps", "-T", "recorder")
        said = one.call("exec", "-T", "recorder", "edgevox-health")
        assert said.stdout.startswith("ok: recording ok")
        wait_until(lambda: ".mcap.open" in one.call(*asked, "ls", "-R", "/recordings").stdout, "it")
        assert "/recordings" in one.call("exec", "-T", "recorder", "df", "/recordings").stdout
        one.execute("recorder", "touch", "/recordings/upload.failed")
        asked_robot = ("exec", "-T", "edgevox-ros2", "edgevox", "doctor", "--only", "running")
        wait_until(lambda: "recorder: the upload fails" in one.call(*asked_robot).stdout, "it")
        one.call("kill", "recorder")
        mended = one.call(*asked, "edgevox-recorder", "--output", "/recordings", "--mend")
        assert mended.returncode == 0, mended.stderr
        listed = one.call(*asked, "ls", "-R", "/recordings").stdout
        assert ".mcap\n" in listed
        assert "metadata.yaml" in listed
        assert ".open" not in listed
        one.call("cp", "recorder:/recordings", str(tmp_path / "saved"))
        assert list((tmp_path / "saved").rglob("*.mcap"))
        version = one.call("exec", "-T", "edgevox-ros2", "edgevox-agent", "--version").stdout
        assert version.strip()
