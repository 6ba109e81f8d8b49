"""Where speech goes: a sound card, a WAV file, ROS 2, or nowhere.

`PacedSink` plays against the clock into any `Outlet`; `SoundCardSink` plays at the card's pace.
`open_sink` chooses by the setting `audio_out`.
"""

from edgevox.voice.sinks.opening import open_sink
from edgevox.voice.sinks.outlet import Outlet
from edgevox.voice.sinks.paced import PacedSink

__all__ = ["Outlet", "PacedSink", "open_sink"]
