"""A client that dies leaves the robot safe: its goal is cancelled."""

import os
import subprocess
import sys
from pathlib import Path

import phrases
import pytest
from action_rig import ActionRig
from guards import HUNG_S
from lease import SHORT_LEASE

CLIENT = str(Path(__file__).with_name("action_client.py"))
# Its lease, and the server waits another 2 s; generously.
GIVEN_UP_S = 60.0


@pytest.fixture
def rig(domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    rig = ActionRig()
    yield rig
    rig.close()


@pytest.fixture
def doomed(rig):
    """A client in a process of its own, whose goal was accepted."""
    process = subprocess.Popen(
        [sys.executable, CLIENT, "/edgevox/execute_skill", "navigate_to", '{"room": "kitchen"}'],
        stdout=subprocess.PIPE,
        env={**os.environ, **SHORT_LEASE},
        text=True,
    )
    assert process.stdout.readline() == "accepted\n"
    yield process
    process.kill()
    process.wait(HUNG_S)
    process.stdout.close()


def test_a_client_killed_in_the_middle_ends_its_goal(rig, doomed):
    rig.driving()
    doomed.kill()
    assert rig.conversation.wait_idle(GIVEN_UP_S)
    assert rig.events[-1]["reason"] == phrases.why("client_gone")


def test_what_was_asked_for_in_words_outlives_a_client(rig, doomed):
    rig.driving()
    rig.say("go to the bedroom")
    rig.driving()
    doomed.terminate()
    doomed.wait(10)
    assert not rig.conversation.wait_idle(5)
    rig.body.arrive()
    assert rig.conversation.wait_idle(10)
    assert rig.said[-1] == "I am in the bedroom."
