"""Look for what `make run` needs and cannot bring itself; say in one line how to get it.

Runs before anything is installed, with whatever Python there is.
"""

import importlib.util
import os
import shutil
import sys
import sysconfig

SUPPORTED = ((3, 11), (3, 12), (3, 13))


def missing_packages():
    """Debian's and Ubuntu's names for what is not here."""
    version = "python{}.{}".format(*sys.version_info[:2])
    missing = []
    if not importlib.util.find_spec("venv") or not importlib.util.find_spec("ensurepip"):
        missing.append(version + "-venv")
    if not os.path.isfile(os.path.join(sysconfig.get_paths()["include"], "Python.h")):
        missing.append(version + "-dev")
    if not shutil.which("cc") or not shutil.which("c++"):
        missing.append("build-essential")
    return missing


def main():
    """0 if all is there."""
    if sys.version_info[:2] not in SUPPORTED:
        sys.stderr.write(
            "EdgeVox needs Python 3.11, 3.12 or 3.13; {} is {}.{}. "
            "Choose another: make PYTHON=python3.12 ...\n".format(
                sys.executable, *sys.version_info[:2]
            )
        )
        return 1
    missing = missing_packages()
    if missing:
        sys.stderr.write("Missing; get it with: sudo apt install " + " ".join(missing) + "\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
