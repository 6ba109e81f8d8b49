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
    home = Path(environment.get("ROS_HOME") or Path("~/.ros").expanduser())
    logs = Path(environment.get("ROS_LOG_DIR") or home / "log")
    sound = [Path(audio_out).absolute().parent] if audio_out.lower().endswith(".wav") else []
    return (default_root(environment), logs, Path(tempfile.gettempdir()), *sound)
