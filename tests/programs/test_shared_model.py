"""A language model that several robots share, and a whole robot that one moves."""

import os
import subprocess
import sys
from pathlib import Path

from guards import HUNG_S
from llm_server import good, serving

AGENT = Path(sys.executable).with_name("edgevox-agent")
WISH = "I'd be glad of some company next to the oven"


def test_a_wish_moves_a_robot_by_a_shared_model(tmp_path: Path) -> None:
    key = tmp_path / "key"
    key.write_text("hunter")
    call = good("call: ", 'navigate_to(room="kitchen"); ', "done")
    with serving(call) as server:
        ran = subprocess.run(
            [AGENT, "robot-apartment", "--text-mode", "--simple-ui", "--llm", "none"],
            input=f"{WISH}\n",
            capture_output=True,
            text=True,
            timeout=HUNG_S,
            env=os.environ
            | {"EDGEVOX_LLM_ENDPOINT": server.url, "EDGEVOX_LLM_ENDPOINT_KEY_FILE": str(key)},
        )

    assert ran.returncode == 0
    assert "I am in the kitchen." in ran.stdout
    assert set(server.keys) == {"Bearer hunter"}
    assert "hunter" not in ran.stdout + ran.stderr
    # Not only in the last request: between turns the prompt's beginning is asked for, to be warm.
    assert any(WISH in str(asked["messages"]) for asked in server.asked)
