"""Whether stop words are heard by their sound, too."""

from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.models import locate
from edgevox.voice.stop_detector import StopDetector
from edgevox.voice.stop_encoder import ENCODER
from edgevox.voice.stop_spotter import open_stop_spotter

log = get_logger(__name__)


def open_stop_detector(settings: Settings) -> StopDetector | None:
    """What hears them, loaded.

    None where nobody asks for it, or, which is logged, where its model is not here or cannot be
    loaded: stop words are heard by their words all the same.
    """
    if not settings.stop_spotter:
        return None
    try:
        spotter = open_stop_spotter(locate(ENCODER))
        spotter.warm_up()
    except Exception as error:  # noqa: BLE001 - whatever its library raises, the robot starts
        log.warning("stop_spotter_missing", reason=str(error))
        return None
    return spotter
