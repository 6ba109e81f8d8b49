"""Where ROS 2 is asked for security that lets strangers in, no program becomes a node."""

import os
import sys

import pytest
from guards import run_program


@pytest.mark.parametrize(
    ("module", "arguments"),
    [("agent.main", ["robot-apartment", "--ros2"]), ("edgevox", ["--ros2"]), ("recorder", [])],
)
def test_outside_of_a_container_each_program_refuses_the_same_before_a_node(module, arguments):
    started = f"from edgevox.apps.{module} import main; raise SystemExit(main({arguments!r}))"
    given = {"ROS_SECURITY_STRATEGY": "Permissive", "EDGEVOX_LOG_FORMAT": "console"}
    ran = run_program(
        [sys.executable, "-c", started],
        env={name: v for name, v in os.environ.items() if "SECURITY" not in name} | given,
    )
    assert ran.returncode == 2
    assert "ROS_SECURITY_STRATEGY: got 'Permissive', expected Enforce" in ran.stderr
    assert "ROS 2: /" not in ran.stdout
