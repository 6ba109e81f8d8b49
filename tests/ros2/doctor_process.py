"""`edgevox doctor` as a process: what it says of this machine."""

import json
import os
from pathlib import Path

from agent_process import AGENT
from guards import run_program

EDGEVOX = str(Path(AGENT).with_name("edgevox"))


def ask_doctor(*arguments, domain, **environment):
    """Its exit code, and its verdicts by check."""
    ours = {name: v for name, v in os.environ.items() if not name.startswith("EDGEVOX_")}
    done = run_program(
        [EDGEVOX, "doctor", "--json", *arguments],
        env=ours | {"ROS_DOMAIN_ID": str(domain), **environment},
    )
    checks = {}
    for one in json.loads(done.stdout)["checks"]:
        checks.setdefault(one["check"], []).append(one)
    return done.returncode, checks
