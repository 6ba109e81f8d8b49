"""Whether somebody speaks, where something of the robot's own voice may be left in what is heard.

Two detectors of voices: one hears as little as possible of the robot and loses parts of a person;
the other hears all of a person and some of the robot, and counts while it is known by other means
that somebody speaks.
"""

from typing import NamedTuple

from edgevox.voice.echo import Unechoed
from edgevox.voice.endpoint import VOICED
from edgevox.voice.vad import VoiceDetector


class FoundVoice(NamedTuple):
    """How likely a frame holds somebody's voice, 0 to 1, and whether it holds one that may be
    somebody's.
    """

    probability: float
    surmised: bool


class VoiceOverEcho:
    """Takes every frame in turn; of the detector it takes another one as soon as it needs it."""

    def __init__(self, vad: VoiceDetector) -> None:
        self._vad = vad
        self._beside: VoiceDetector | None = None
        self._goes_on = False

    @property
    def any_voice(self) -> float:
        """See `VoiceDetector`; of the first detector."""
        return self._vad.any_voice

    def of(self, sound: Unechoed) -> FoundVoice:
        """Of the next frame."""
        probability = self._vad.probability(sound.voice)
        if not sound.cancelled:
            self._goes_on = False
            return FoundVoice(probability, surmised=False)
        beside = self._beside = self._beside or self._vad.another()
        if not self._goes_on:
            beside.reset()
        self._goes_on = True
        surmised = beside.probability(sound.words)
        if sound.somebody:
            probability = max(probability, surmised)
        return FoundVoice(probability, surmised >= VOICED)

    def reset(self) -> None:
        """The next frame does not follow on those before."""
        self._vad.reset()
        self._goes_on = False
