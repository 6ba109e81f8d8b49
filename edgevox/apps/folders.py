"""The folders that EdgeVox writes to on this machine."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from edgevox.core.settings import Settings
from edgevox.models.store import default_root


def written_folders(
    settings: Settings, environment: Mapping[str, str] = os.environ
) -> tuple[Path, ...]:
    """Return the folders that may be written.

    Models, ROS 2's logs, temporary files, places, sound.
    """
    out = settings.audio_out
    sound = [Path(out).absolute().parent] if out.lower().endswith(".wav") else []
    temporary = Path(tempfile.gettempdir())
    needed = needed_folders(settings, environment)
    return (default_root(environment), ros_logs(environment), temporary, *needed, *sound)


def needed_folders(
    settings: Settings, environment: Mapping[str, str] = os.environ
) -> tuple[Path, ...]:
    """Return the folders of what is to be kept: places, sound, pictures, the console's own."""
    console = [console_folder(settings, environment), recordings_folder(settings, environment)]
    asked = (settings.keep_audio, settings.pictures)
    kept = [one.expanduser() for one in asked if one]
    return (places_folder(settings, environment), *kept, *(console if settings.console else ()))


def console_folder(settings: Settings, environment: Mapping[str, str] = os.environ) -> Path:
    """The folder of the console: the settings', else one of its own among the user's state."""
    if settings.console_folder:
        return settings.console_folder.expanduser()
    return _state(environment) / "console"


def recordings_folder(settings: Settings, environment: Mapping[str, str] = os.environ) -> Path:
    """The folder of the console's recordings: the settings', else one in the console's."""
    if settings.console_recordings:
        return settings.console_recordings.expanduser()
    return console_folder(settings, environment) / "recordings"


def pictures_folder(settings: Settings, environment: Mapping[str, str] = os.environ) -> Path:
    """The folder of the pictures that are asked for: the settings', else beside the recordings."""
    if settings.pictures:
        return settings.pictures.expanduser()
    return recordings_folder(settings, environment) / "pictures"


def places_folder(settings: Settings, environment: Mapping[str, str] = os.environ) -> Path:
    """The folder of remembered places: the settings', else EdgeVox's among the user's state."""
    if settings.places:
        return settings.places.expanduser()
    return _state(environment)


def voiceprints_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """The folder of the voice prints of people: one of EdgeVox's among the user's state."""
    return _state(environment) / "voiceprints"


def _state(environment: Mapping[str, str]) -> Path:
    home = Path(environment.get("HOME") or "~").expanduser()
    return Path(environment.get("XDG_STATE_HOME") or home / ".local" / "state") / "edgevox"


def ros_logs(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder of ROS 2's logs."""
    home = Path(environment.get("HOME") or "~").expanduser()
    ros_home = Path(environment.get("ROS_HOME") or home / ".ros")
    return Path(environment.get("ROS_LOG_DIR") or ros_home / "log")
