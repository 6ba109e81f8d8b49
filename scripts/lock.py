"""Lock what the virtual environment installs: `compile` resolves anew, `check` only looks.

A lock starts with a fingerprint of what it was made from (its ``.in`` file and the dependencies
that pyproject.toml declares), so that `check` needs neither the network nor a resolver.
"""

import hashlib
import json
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / "requirements"
NAMES = (  # those that others constrain come first
    "tools",
    "run",
    "dev",
    "sdist",
    "build",
    "llama-cpp",
    "base",
    "image",
    "slim",
)
# 108 MB of readings that misaki's other Chinese, which no voice of ours speaks, would look up.
IMAGE = ("--override=requirements/image.override", "--no-emit-package=pypinyin-dict")
SPECIAL = {
    "dev": ("--no-emit-package=llama-cpp-python",),  # built by scripts/build_llama_cpp.py
    "llama-cpp": ("--no-deps", "--no-binary=llama-cpp-python"),
    "image": IMAGE,
    "slim": IMAGE,
}
MARK = "# Locked from sha256:"
OPTIONS = (
    "--universal",
    "--python-version=3.11",
    "--fork-strategy=fewest",
    "--generate-hashes",
    "--no-header",
    "--no-annotate",
    "--no-emit-index-url",
    "--no-emit-find-links",
    "--no-emit-package=edgevox-robot",
    "--quiet",
)


def fingerprint(name: str) -> str:
    """What the lock of this name depends on, as one hash."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = {key: project[key] for key in ("dependencies", "optional-dependencies")}
    overrides = (option.partition("--override=")[2] for option in SPECIAL.get(name, ()))
    sources = [REQUIREMENTS / f"{name}.in", *(ROOT / path for path in overrides if path)]
    source = "".join(path.read_text(encoding="utf-8") for path in sources)
    used = declared if "-e ." in source else {}
    return hashlib.sha256(f"{source}{json.dumps(used, sort_keys=True)}".encode()).hexdigest()


def compile_lock(name: str) -> None:
    """Resolve one ``.in`` file into its lock; an existing lock keeps versions that still fit."""
    lock = REQUIREMENTS / f"{name}.lock"
    uv = Path(sysconfig.get_path("scripts")) / "uv"
    options = (*OPTIONS, *SPECIAL.get(name, ()))
    command = [uv, "pip", "compile", *options, f"requirements/{name}.in", "-o", lock]
    subprocess.run(command, cwd=ROOT, check=True)
    body = "".join(line for line in lock.open(encoding="utf-8") if not line.startswith("#"))
    lock.write_text(
        f"{MARK}{fingerprint(name)} by `make lock`. Do not edit.\n{body}", encoding="utf-8"
    )


def stale(name: str) -> bool:
    """Whether the lock was made from something else than what is there now."""
    lock = REQUIREMENTS / f"{name}.lock"
    return (
        not lock.is_file()
        or f"{MARK}{fingerprint(name)} " not in lock.open(encoding="utf-8").readline()
    )


def main(arguments: list[str]) -> int:
    """Run `compile` or `check`; 2 for anything else."""
    match arguments:
        case ["compile"]:
            for name in NAMES:
                compile_lock(name)
            return 0
        case ["check"]:
            old = [f"requirements/{name}.lock" for name in NAMES if stale(name)]
            if old:
                sys.stderr.write(f"{', '.join(old)}: older than its inputs; run `make lock`\n")
            return 1 if old else 0
    sys.stderr.write("usage: lock.py compile|check\n")
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
