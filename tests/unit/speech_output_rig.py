"""Speech output in simulated time: voices that beep, a loudspeaker that remembers."""

import threading
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from guards import HUNG_S

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import Voice
from edgevox.voice.audio import Chunk, Samples
from edgevox.voice.tts.voices import VoiceChoice

RATE_HZ = 16_000
CHAR_S = 0.1


class Recorder:
    """An output that keeps what it was given, and when."""

    name = "recorder"
    rate_hz = RATE_HZ
    block_s = 0.02
    lead_s = 0.0

    def __init__(self) -> None:
        self.blocks: list[tuple[float, Samples]] = []
        self.on_write: Callable[[float], None] = lambda start_s: None

    def write(self, samples: Samples, start_s: float) -> None:
        self.blocks.append((start_s, samples))
        self.on_write(start_s)

    def close(self) -> None: ...

    @property
    def seconds(self) -> float:
        return sum(len(samples) for _, samples in self.blocks) / RATE_HZ

    @property
    def end_s(self) -> float:
        start_s, samples = self.blocks[-1]
        return start_s + len(samples) / RATE_HZ


class Beeper:
    """A voice that beeps a tenth of a second a character, a chunk a word; it can be held up."""

    sample_rate_hz = RATE_HZ
    phrase_chars = 1000

    def __init__(self) -> None:
        self.heard: list[str] = []
        self.fails_on: str | None = None
        self.before_chunk: Callable[[str], None] = lambda word: None
        self.chunks = 0

    def warm_up(self) -> None: ...

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        self.heard.append(sentence)
        for word in sentence.split(" "):
            if token.cancelled:
                return
            if self.fails_on and self.fails_on in word:
                raise RuntimeError(f"no way to say {word}")
            self.before_chunk(word)
            self.chunks += 1
            yield Chunk(beep((len(word) + 1) * CHAR_S), RATE_HZ)


class Voices:
    """A pool of such voices, by name."""

    def __init__(self, **voices: Beeper) -> None:
        self.voices = voices
        self.loaded: list[str] = []

    def get(self, choice: VoiceChoice) -> Beeper:
        self.loaded.append(choice.name)
        if choice.name not in self.voices:
            raise EdgeVoxError(f"voice {choice.name}: its file is gone")
        return self.voices[choice.name]


def beep(seconds: float) -> Samples:
    return np.full(round(seconds * RATE_HZ), 8000, np.int16)


def choices(*names: str, language: str = "en") -> Sequence[VoiceChoice]:
    return [VoiceChoice(language, Voice(name, "test", name)) for name in names]


def wait_for(event: threading.Event) -> None:
    assert event.wait(HUNG_S), "it did not happen"
