"""Build llama-cpp-python for any CPU of this kind, keep the wheel, and install it.

Its defaults compile for the builder's own CPU, and the result crashes on others. Building takes
minutes, so the wheel stays in the user's cache, under a name made of its source and its options.
"""

import hashlib
import os
import platform
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "requirements" / "llama-cpp.lock"
BASELINE = {
    "x86_64": ("-DGGML_AVX2=ON", "-DGGML_FMA=ON", "-DGGML_F16C=ON", "-DGGML_BMI2=ON"),
}
CMAKE_ARGS = " ".join(
    ("-DGGML_NATIVE=OFF", "-DLLAVA_BUILD=OFF", *BASELINE.get(platform.machine(), ()))
)


def shelf() -> Path:
    """The folder that holds, or will hold, the wheel of this source with these options."""
    what = (
        f"{LOCK.read_text(encoding='utf-8')}{CMAKE_ARGS}{platform.machine()}{platform.libc_ver()}"
    )
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    key = hashlib.sha256(what.encode()).hexdigest()[:16]
    return cache / "edgevox" / "wheels" / f"llama-cpp-python-{key}"


def build(place: Path) -> None:
    """Build the wheel into a folder, with the build tools of this virtual environment."""
    place.parent.mkdir(parents=True, exist_ok=True)
    scripts = sysconfig.get_path("scripts")
    environment = {
        **os.environ,
        "CMAKE_ARGS": CMAKE_ARGS,
        "PATH": f"{scripts}{os.pathsep}{os.environ.get('PATH', '')}",
    }
    # Not pip's own cache: it does not tell wheels of different options apart.
    options = ("--no-deps", "--no-build-isolation", "--no-cache-dir", "--require-hashes")
    with tempfile.TemporaryDirectory(dir=place.parent) as staging:
        command = ("wheel", *options, "--requirement", LOCK, "--wheel-dir", staging)
        _pip(*command, environment=environment)
        (wheel,) = Path(staging).glob("*.whl")
        place.mkdir(exist_ok=True)
        wheel.replace(place / wheel.name)


def _pip(*arguments: str | Path, environment: dict[str, str] | None = None) -> None:
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments]
    subprocess.run(command, env=environment, check=True)


def main() -> int:
    """Build if need be, then install."""
    place = shelf()
    if not list(place.glob("*.whl")):
        sys.stderr.write(f"building llama-cpp-python into {place}: minutes, once\n")
        build(place)
    _pip("install", "--quiet", "--no-deps", "--no-index", "--force-reinstall", *place.glob("*.whl"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
