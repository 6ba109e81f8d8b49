"""A node starts, and finds who is there, when one of its peers has no address."""

import os
import subprocess
import sys

import pytest
from guards import run_program

pytestmark = pytest.mark.long

MAKE_A_NODE = "import rclpy; rclpy.init(); print(rclpy.create_node('here').get_name())"
PEERS = "nobody.invalid;127.0.0.1"


def _made(domain: int, *command: str) -> subprocess.CompletedProcess[str]:
    peers = {"ROS_STATIC_PEERS": PEERS, "EDGEVOX_PEERS_WAIT_S": "0", "ROS_DOMAIN_ID": str(domain)}
    # A container's index of packages names the middlewares; here there is none before rclpy is.
    ours = ("EDGEVOX_", "RMW_")
    others = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    return run_program([*command, sys.executable, "-c", MAKE_A_NODE], env=others | peers)


def test_the_entrypoint_leaves_out_what_would_keep_a_node_from_starting(domain) -> None:
    started = _made(domain, sys.executable, "-m", "edgevox.apps.container.start")

    assert (started.stdout, started.returncode) == ("here\n", 0)
    assert "no address of nobody.invalid" in started.stderr


def test_without_it_the_middleware_makes_no_node_at_all(domain) -> None:
    assert "Unable to resolve peer nobody.invalid" in _made(domain).stderr
