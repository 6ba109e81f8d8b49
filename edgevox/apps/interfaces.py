"""`edgevox interfaces`: build a robot's packages of ROS 2 interfaces, for its robot file."""

import argparse
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

from edgevox.apps.streams import show, with_streams
from edgevox.core.files.text import one_line
from edgevox.ros2.interface_packages import SETUP, Builder, BuildFailed, Package, packages_in

OK, FAILED = 0, 1


@with_streams("edgevox interfaces", results=True)
def main(argv: Sequence[str] | None = None) -> int:
    """Build the packages of folders and archives; 0, or 1 and a line that says why not."""
    asked = _parser().parse_args(argv)
    try:
        with ExitStack() as stack:
            packages = [found for one in asked.sources for found in _packages(one, stack)]
            Builder(asked.to or Path(sys.prefix), show).build(packages)
    except (BuildFailed, OSError, shutil.ReadError) as error:
        show(f"edgevox interfaces: {error}", error=True)
        return FAILED
    if asked.to and (asked.to / SETUP).is_file():
        show(f"now: source {asked.to / SETUP}")
    return OK


def _packages(source: Path, stack: ExitStack) -> Iterator[Package]:
    folder = source
    if source.is_file():
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="edgevox-archive-")))
        if source.suffix == ".zip":
            shutil.unpack_archive(source, folder)
        else:
            shutil.unpack_archive(source, folder, filter="data")
    found = packages_in(folder)
    if not found:
        expected = "a folder, at any depth, that has a folder msg, srv or action with definitions"
        raise BuildFailed(f"{one_line(str(source))}: expected {expected}")
    yield from found


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox interfaces",
        description="Build packages of ROS 2 interfaces (.msg, .srv, .action) for robot files, "
        "without colcon. Needs a C++ compiler.",
    )
    parser.add_argument(
        "sources",
        nargs="+",
        type=Path,
        metavar="FOLDER",
        help="a package, a folder of packages, or an archive of one (.zip, .tar.gz)",
    )
    parser.add_argument(
        "--to",
        type=Path,
        metavar="FOLDER",
        help="build into this folder, and source its setup.bash; by default into the Python "
        "environment of EdgeVox, which needs nothing else",
    )
    return parser
