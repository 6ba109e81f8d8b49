"""`edgevox doctor` as a process: what it says of this machine."""

import json
import os
import subprocess
from pathlib import Path

from agent_process import AGENT
from guards import HUNG_S

EDGEVOX = str(Path(AGENT).with_name("edgevox"))


def ask_doctor(*arguments, domain, **environment):
    """Its exit code, and its verdicts by check."""
    ours = {name: v for name, v in os.environ.items() if not name.startswith("EDGEVOX_")}
    done = subprocess.run(
        [EDGEVOX, "doctor", "--json", *arguments],
        env=ours | {"ROS_DOMAIN_ID": str(domain), **environment},
        capture_output=True,
        text=True,
        timeout=HUNG_S,
    )
    checks = {}
    for one in json.loads(done.stdout)["checks"]:
        checks.setdefault(one["check"], []).append(one)
    return done.returncode, checks
