"""Everything around a listener, scripted: a voice is a frame whose samples are 8000."""

import threading

import numpy as np

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, EndOfSound, Frame
from edgevox.voice.stt.speech_to_text import Transcript

VOICE, WAKE, BUTTON = 8000, 12000, 8001
"""A voice, the wake word, and a voice while its talk button is held."""
SILENCE_AFTER = 30


class Script:
    """A source that plays levels, one for each frame; calls what stands between them."""

    name = "script"

    def __init__(self, *steps):
        self.steps = list(steps)
        self.count = 0

    def start(self):
        pass

    def read(self, timeout_s):
        while self.steps and callable(self.steps[0]):
            self.steps.pop(0)()
        if not self.steps:
            raise EndOfSound("script: over")
        self.count += 1
        level = self.steps.pop(0)
        samples = np.full(FRAME_SAMPLES, level, np.int16)
        return Frame(samples, self.count * FRAME_S, addressed=level == BUTTON)

    def close(self):
        pass


class Vad:
    any_voice = 0.0

    def probability(self, samples):
        self.any_voice = 1.0 if samples[0] >= VOICE else 0.0
        return self.any_voice

    def reset(self):
        pass


class Wake:
    phrase = "hey jarvis"

    def heard(self, samples, probability, language="en"):
        return bool(samples[0] == WAKE)

    def reset(self):
        pass


class Stt:
    def __init__(self, *texts):
        self.texts = list(texts)
        self.languages = []
        self.heard = []

    def transcribe(self, samples, language):
        self.languages.append(language)
        self.heard.append(samples)
        text = self.texts.pop(0)
        if isinstance(text, Exception):
            raise text
        return Transcript(text)

    def warm_up(self, language):
        pass

    def close(self):
        pass


class Refuses(list):
    """Breaks at the first command of a kind, and takes what comes then."""

    def __init__(self, kind):
        super().__init__()
        self.kind, self.broke = kind, threading.Event()

    def append(self, command):
        if isinstance(command, self.kind) and not self.broke.is_set():
            self.broke.set()
            raise RuntimeError("once")
        super().append(command)


def spoken(frames=20, after=SILENCE_AFTER):
    return [VOICE] * frames + [0] * after
