"""The files for systemd and Podman are taken by both: `make units`, where both are installed."""

import os
import subprocess
import sys

from guards import HUNG_S
from test_service_units import QUADLET, UNIT

GENERATOR = os.environ.get("QUADLET", "/usr/libexec/podman/quadlet")


def test_systemd_takes_the_unit():
    seen = subprocess.run(
        ["systemd-analyze", "verify", str(UNIT)], capture_output=True, text=True, timeout=HUNG_S
    )
    assert (seen.returncode, seen.stdout + seen.stderr) == (0, "")


def test_podman_makes_a_unit_of_the_quadlet_that_systemd_takes(tmp_path):
    made = subprocess.run(
        [GENERATOR, "-dryrun"],
        env={**os.environ, "QUADLET_UNIT_DIRS": str(QUADLET.parent)},
        capture_output=True,
        text=True,
        timeout=HUNG_S,
    )
    assert made.returncode == 0, made.stderr
    assert "nsupported" not in made.stderr
    unit = tmp_path / "edgevox.service"
    text = made.stdout.partition("---edgevox.service---\n")[2]
    unit.write_text(text.replace("/usr/bin/podman", sys.executable), encoding="utf-8")
    seen = subprocess.run(
        ["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, timeout=HUNG_S
    )
    assert (seen.returncode, seen.stdout + seen.stderr) == (0, "")
