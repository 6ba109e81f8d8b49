"""Where EdgeVox writes on this machine."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from edgevox.models.store import default_root


def written_folders(
    audio_out: str = "", environment: Mapping[str, str] = os.environ
) -> tuple[Path, ...]:
    """Where EdgeVox may write: models, ROS 2's logs, what is temporary, recordings."""
    sound = [Path(audio_out).absolute().parent] if audio_out.lower().endswith(".wav") else []
    temporary = Path(tempfile.gettempdir())
    return (default_root(environment), ros_logs(environment), temporary, *sound)


def ros_logs(environment: Mapping[str, str] = os.environ) -> Path:
    """Where ROS 2 logs."""
    home = Path(environment.get("HOME") or "~").expanduser()
    ros_home = Path(environment.get("ROS_HOME") or home / ".ros")
    return Path(environment.get("ROS_LOG_DIR") or ros_home / "log")
