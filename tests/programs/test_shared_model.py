"""A language model that several robots share, and what a whole robot does by it: it talks."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from guards import run_program
from llm_server import good, serving

from edgevox.agent.llm.protocol import SAY

pytestmark = pytest.mark.long

AGENT = Path(sys.executable).with_name("edgevox-agent")
WISH = "why does ice float on water?"
ANSWER = "That would be nice indeed."


def ask(said: str, server_url: str, key: Path) -> "subprocess.CompletedProcess[str]":
    """A whole robot that is told this, with a model on a server."""
    return run_program(
        [AGENT, "robot-apartment", "--text-mode", "--simple-ui", "--llm", "none"],
        input=f"{said}\n",
        env=os.environ
        | {"EDGEVOX_LLM_ENDPOINT": server_url, "EDGEVOX_LLM_ENDPOINT_KEY_FILE": str(key)},
    )


@pytest.fixture
def key(tmp_path: Path) -> Path:
    file = tmp_path / "key"
    file.write_text("hunter")
    return file


def test_a_shared_model_answers_what_no_robot_does(key: Path) -> None:
    with serving(good(SAY, ANSWER)) as server:
        ran = ask(WISH, server.url, key)

    assert ran.returncode == 0
    assert ANSWER in ran.stdout
    assert set(server.keys) == {"Bearer hunter"}
    assert "hunter" not in ran.stdout + ran.stderr
    # Not only in the last request: between turns the prompt's beginning is asked for, to be warm.
    assert any(WISH in str(asked["messages"]) for asked in server.asked)


def test_a_shared_model_that_heeds_no_grammar_moves_no_robot(key: Path) -> None:
    with serving(good("call: ", 'navigate_to(room="kitchen"); ', "done")) as server:
        ran = ask(WISH, server.url, key)

    assert ran.returncode == 0
    assert "I cannot think right now" in ran.stdout
    assert "kitchen" not in ran.stdout
