"""Whether a stop word that the spotter missed stops the robot by its words, once they are known."""

from heard_robot import Robot

from edgevox.agent.near_stop import NearStop
from edgevox.agent.safety import SafetyWords
from edgevox.apps.decision import open_phonemes
from edgevox.voice.audio import Samples


class Words:
    """What Whisper makes of a sound, utterance by utterance, and whether that stops a robot that
    drives: by a stop word, or by words that sound like one.
    """

    def __init__(self) -> None:
        self._robot = Robot("robot-apartment")
        self._safety = SafetyWords("en")
        phonemes = open_phonemes()
        self._near = NearStop("en", phonemes) if phonemes else None

    def stop(self, sound: Samples) -> bool:
        """Whether they do."""
        return any(self._is_stop(said.text) for said in self._robot.hear(sound))

    def _is_stop(self, text: str) -> bool:
        near = self._near.find(text) if self._near else None
        return (self._safety.find(text) or near) is not None
