"""Build edgevox_msgs and tf2_msgs into the virtual environment whose Python runs this.

For machines that have ROS 2 from the Python index; a ROS 2 installation builds edgevox_msgs with
colcon and has a tf2_msgs. Needs a C and a C++ compiler, and what requirements/build.lock names.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from importlib import metadata
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PREFIX = Path(sys.prefix)
PACKAGES = ("edgevox_msgs", "tf2_msgs")
STAMP = PREFIX / "share" / "edgevox_msgs" / "built-from"
# Where the interfaces' wheels were built; their CMake files still look for headers there.
BUILDERS_PYTHON = re.compile(r"/opt/python/cp\d+-cp\d+/include/python3\.\d+")
BUILDERS_NUMPY = re.compile(
    r"/opt/python/cp\d+-cp\d+/lib/python3\.\d+/site-packages/numpy/_?core/include"
)
# Another environment's, or a sourced ROS 2's: none of it may leak into this build.
FOREIGN = ("PYTHONPATH", "LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE", "PYTHONHOME")


def fingerprint() -> str:
    """All that the built packages depend on, as one hash."""
    digest = hashlib.sha256(sys.version.encode())
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*")):
            if path.is_file():
                digest.update(f"{path.relative_to(ROOT)}".encode() + path.read_bytes())
    for name in ("ros-rosidl-generator-py", "ros-rclpy", "numpy"):
        digest.update(f"{name} {metadata.version(name)}".encode())
    return digest.hexdigest()


def patch_cmake_files() -> None:
    """Point the wheels' CMake files to this machine's headers of Python and numpy."""
    python = sysconfig.get_path("include")
    for path in (PREFIX / "share").glob("*/cmake/*.cmake"):
        old = path.read_text(encoding="utf-8")
        new = BUILDERS_NUMPY.sub(np.get_include(), BUILDERS_PYTHON.sub(python, old))
        if new != old:
            path.write_text(new, encoding="utf-8")


def environment() -> dict[str, str]:
    """The variables of a build that sees this virtual environment and nothing else of ROS."""
    kept = {key: value for key, value in os.environ.items() if key not in FOREIGN}
    scripts = sysconfig.get_path("scripts")
    return {
        **kept,
        "AMENT_PREFIX_PATH": str(PREFIX),
        "CMAKE_PREFIX_PATH": str(PREFIX),
        "PATH": f"{scripts}{os.pathsep}{kept.get('PATH', '')}",
    }


def build(package: str, place: Path) -> None:
    """Configure, build and install one interface package."""
    definitions = (
        f"-DCMAKE_INSTALL_PREFIX={PREFIX}",
        f"-DPython3_EXECUTABLE={sys.executable}",
        "-DBUILD_TESTING=OFF",
        "-Wno-dev",
        "-Wno-deprecated",
    )
    _run(["cmake", "-S", ROOT / package, "-B", place, "-G", "Ninja", *definitions])
    _run(["cmake", "--build", place, "--target", "install"])


def _run(command: list[str | Path]) -> None:
    scripts = sysconfig.get_path("scripts")
    program = shutil.which(str(command[0]), path=environment()["PATH"]) or f"{scripts}/{command[0]}"
    done = subprocess.run(
        [program, *command[1:]],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        check=False,
    )
    if done.returncode != 0:
        sys.exit(f"{done.stdout}\nbuild_msgs: {' '.join(map(str, command))} failed, see above")


def main() -> int:
    """Build what is not built yet from these very sources."""
    if STAMP.is_file() and STAMP.read_text(encoding="utf-8") == fingerprint():
        return 0
    patch_cmake_files()
    with tempfile.TemporaryDirectory(prefix="edgevox-msgs-") as place:
        for package in PACKAGES:
            build(package, Path(place) / package)
            sys.stderr.write(f"built {package}\n")
    STAMP.write_text(fingerprint(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
