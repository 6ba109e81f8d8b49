"""Where robots keep the places that they were told to remember."""

import os
from collections.abc import Mapping
from pathlib import Path

from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, RemembersPlaces
from edgevox.robots.places.store import PlaceStore


def places_folder(settings: Settings, environment: Mapping[str, str] = os.environ) -> Path:
    """The folder that the settings name, else EdgeVox's among the user's state."""
    if settings.places:
        return settings.places.expanduser()
    home = Path(environment.get("HOME") or "~").expanduser()
    return Path(environment.get("XDG_STATE_HOME") or home / ".local" / "state") / "edgevox"


def open_places(body: Body, settings: Settings) -> None:
    """Have a body that can remember places recall them, and keep what it learns from now on."""
    if isinstance(body, RemembersPlaces):
        body.place_memory.open(PlaceStore(places_folder(settings)), body.name)
