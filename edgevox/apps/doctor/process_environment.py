"""The checks of this process: its settings, its writable folders, and its container."""

import os
import tempfile
from pathlib import Path

from edgevox.apps.container.environment import warn_of_unknown
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, skipped, warning
from edgevox.apps.folders import ros_logs
from edgevox.ops.diagnostics.disk import room


def probe_settings(situation: Situation) -> Facts:
    """List the given variables, and the unknown ones among them."""
    unknown: list[str] = []
    warn_of_unknown(situation.environment, unknown.append)
    given = sorted(name for name in situation.environment if name.startswith("EDGEVOX_"))
    return {"given": given, "unknown": unknown}


def judge_settings(facts: Facts, situation: Situation) -> list[CheckVerdict]:
    """Judge the settings: only here is a misspelled variable reported."""
    unknown = [warning(one, "correct or remove it") for one in facts["unknown"]]
    if situation.refused:
        advice = "correct it; the other checks used the defaults"
        return [error(situation.refused, advice), *unknown]
    count = len(facts["given"]) - len(unknown)
    return [*unknown, ok(f"valid; {count} from environment variables")]


def probe_folders(situation: Situation) -> Facts:
    """Test whether files can be made where they must be."""
    logs = ros_logs(situation.environment)
    return {
        "tmp": room(Path(tempfile.gettempdir())).writable,
        "logs": room(logs).writable,
        "at": str(logs),
    }


def judge_folders(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge the folders: a read-only root may lack a tmpfs."""
    if not facts["tmp"]:
        return error("no folder for temporary files", "mount a tmpfs at /tmp")
    if not facts["logs"]:
        advice = (
            "ROS 2 starts only where it can log: set ROS_LOG_DIR to a folder that can be written"
        )
        return warning(f"{facts['at']} cannot be written", advice)
    return ok("temporary files and ROS 2's logs can be written")


def probe_container(_: Situation) -> Facts:
    """Find out whether this is a container, and its user."""
    inside = Path("/.dockerenv").exists() or Path("/run/.containerenv").exists()
    return {
        "inside": inside or "KUBERNETES_SERVICE_HOST" in os.environ,
        "uid": os.getuid(),
        "read_only": bool(os.statvfs("/").f_flag & os.ST_RDONLY),
    }


def judge_container(facts: Facts, _: Situation) -> CheckVerdict:
    """Root in a container is more than a robot needs."""
    if not facts["inside"]:
        return skipped("not in a container")
    root = "read-only" if facts["read_only"] else "writable"
    found = f"uid {facts['uid']}, {root} root file system"
    if facts["uid"] == 0:
        return warning(found, "run it as its own user (uid 1000), as docker-compose.ros2.yml does")
    return ok(found)
