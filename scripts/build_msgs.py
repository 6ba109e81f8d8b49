"""Build edgevox_msgs and tf2_msgs into the virtual environment whose Python runs this.

For machines that have ROS 2 from the Python index; a ROS 2 installation builds edgevox_msgs with
colcon and has a tf2_msgs. Needs a C and a C++ compiler, and what requirements/build.lock names.
"""

import sys
from pathlib import Path

from edgevox.ros2.interface_packages import Builder, BuildFailed, packages_in

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("edgevox_msgs", "tf2_msgs")


def main() -> int:
    """Build what is not built yet from these very sources."""
    packages = [found for one in PACKAGES for found in packages_in(ROOT / one)]
    try:
        Builder(Path(sys.prefix), lambda line: sys.stderr.write(f"{line}\n")).build(packages)
    except BuildFailed as error:
        sys.exit(f"build_msgs: {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
