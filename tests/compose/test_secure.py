"""DDS security in a container: enforced where the image's middleware has it, and else nothing."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from guards import HUNG_S
from stacks import Stack, stack

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))

from enclaves_rig import NOW, make_enclave

pytestmark = [pytest.mark.usefixtures("image"), pytest.mark.long]
SERVICE = "edgevox-ros2"
USAGE = 64
BUILD = (
    "import json; from edgevox.ros2.doctor import middleware_build;"
    " print(json.dumps(middleware_build()))"
)


def _readable(folder: Path) -> Path:
    """By the container's user, who is none of this machine's: these keys are a test's."""
    for one in [folder, *folder.rglob("*")]:
        one.chmod(0o755 if one.is_dir() else 0o644)
    return folder


@pytest.fixture
def site(tmp_path):
    """A folder as SECURITY_FOLDER names it."""
    make_enclave(tmp_path / "robot", "/edgevox/edgevox")
    return tmp_path


def _run(one: Stack, *arguments: str) -> subprocess.CompletedProcess[str]:
    return one.call("run", "--rm", "--no-deps", "-T", *arguments, timeout=HUNG_S)


def test_it_is_enforced_or_the_container_ends_with_one_line(site):
    _readable(site)
    with stack("secure", start=False, SECURITY_FOLDER=str(site)) as one:
        plain = _run(one, "-e", "EDGEVOX_SECURITY_KEYSTORE=", SERVICE, "python3", "-c", BUILD)
        built = json.loads(plain.stdout.splitlines()[-1])
        ran = _run(one, SERVICE, "printenv", "ROS_SECURITY_STRATEGY")
    if built["security"]:
        assert (ran.returncode, ran.stdout) == (0, "Enforce\n")
    else:
        assert (ran.returncode, ran.stdout) == (USAGE, "")
        (said,) = [line for line in ran.stderr.splitlines() if line.startswith("edgevox:")]
        assert "expected a middleware with DDS security" in said


def test_permissive_is_refused_by_its_name(site):
    _readable(site)
    with stack("secure", start=False, SECURITY_FOLDER=str(site)) as one:
        ran = _run(one, "-e", "ROS_SECURITY_STRATEGY=Permissive", SERVICE, "true")
    assert ran.returncode == USAGE
    assert "edgevox: ROS_SECURITY_STRATEGY: got 'Permissive', expected Enforce" in ran.stderr


def test_a_folder_that_the_containers_user_may_not_read_is_told(site):
    """Exported by somebody else and not handed over: uid 1000 does not see into it."""
    _readable(site)
    (site / "robot" / "enclaves").chmod(0o700)
    with stack("secure", start=False, SECURITY_FOLDER=str(site)) as one:
        ran = _run(one, "--user", "4711:4711", SERVICE, "true")
    assert ran.returncode == USAGE
    assert "edgevox: EDGEVOX_SECURITY_KEYSTORE: got '/etc/edgevox/security'" in ran.stderr
    assert "to be read by user 4711" in ran.stderr


def test_a_shell_by_exec_has_what_the_entrypoint_says_or_ends(tmp_path):
    over = tmp_path / "robot"
    make_enclave(over, "/edgevox/edgevox", ends=NOW)
    _readable(tmp_path)
    with stack("secure", start=False, SECURITY_FOLDER=str(tmp_path)) as one:
        ran = _run(one, "--entrypoint", "bash", SERVICE, "-i", "-c", "echo open")
    assert (ran.returncode, ran.stdout) == (USAGE, "")
