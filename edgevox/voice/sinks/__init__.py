"""Destinations of speech: a sound card, a WAV file, ROS 2, or nowhere.

`PacedSink` plays against the clock into any `PacedOutput`; `SoundCardSink` plays at the card's
pace. `open_sink` chooses by the setting `audio_out`.
"""

from edgevox.voice.sinks.open_sink import open_sink
from edgevox.voice.sinks.paced import PacedOutput, PacedSink

__all__ = ["PacedOutput", "PacedSink", "open_sink"]
