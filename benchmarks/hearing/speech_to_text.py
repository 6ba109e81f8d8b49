"""EdgeVox's speech to text beside plain faster-whisper, on the same sound, by turns.

Plain is `WhisperModel.transcribe`, with the library's defaults and with EdgeVox's options.
"""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from voice_engines import words, wrong_words

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.voice.parts import record
from edgevox.apps.agent.queries import find_model
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.tts.voices import choose
from edgevox.voice.wav import resampled

MODEL = "whisper-tiny.en"
TABLE = f"Speech to text, {MODEL}"
SAYINGS = (
    "Go to the kitchen.",
    "What is your battery level?",
    "Could you please drive to the living room?",
    "I have put the cube into the left bin, and now I will come back to the door.",
)
THREADS = 2
DEFAULTS, SAME, OURS = "defaults", "same", "ours"
LABELS = {
    DEFAULTS: "faster-whisper, plain, its defaults",
    SAME: "faster-whisper, plain, our options",
    OURS: "our `Whisper`",
}


def measure(quick: bool = False) -> Measured:
    """Each sentence by all three; which of them begins changes."""
    try:
        path = locate(MODEL)
        sounds = _sounds()
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    ways = _ways(path)
    taken: dict[str, list[float]] = {name: [] for name in ways}
    wrong = dict.fromkeys(ways, 0)
    for hear in ways.values():
        hear(sounds[SAYINGS[0]])
    order = list(ways)
    for _ in range(1 if quick else 5):
        for said, sound in sounds.items():
            for name in order:
                began = time.perf_counter()
                heard = ways[name](sound)
                taken[name].append(1000 * (time.perf_counter() - began))
                wrong[name] += wrong_words(words(said), words(heard))
            order.append(order.pop(0))
    rounds = len(taken[OURS]) // len(sounds)
    number = rounds * sum(len(words(said)) for said in sounds)
    return Measured(figures=tuple(_figures(taken, wrong, number)))


def _figures(taken: dict[str, list[float]], wrong: dict[str, int], number: int) -> Iterator[Figure]:
    for name, samples in taken.items():
        yield Figure.of(
            f"time.{name}", TABLE, LABELS[name], samples, "ms", column="an utterance",
            baseline=f"time.{SAME}" if name == OURS else "",
        )  # fmt: skip
        yield Figure.of(
            f"wrong.{name}", TABLE, LABELS[name], [100 * wrong[name] / number], "%",
            column="words wrong",
        )  # fmt: skip


def _sounds() -> dict[str, Samples]:
    """Each sentence at 16 kHz, spoken by Piper."""
    chunks = record(choose("en", "", find_model)[0], SAYINGS)
    return {
        said: resampled(one.samples, one.rate_hz, RATE_HZ)
        for said, one in zip(SAYINGS, chunks, strict=True)
    }


def untouched(path: Path) -> Callable[..., str]:
    """Plain faster-whisper: the words of a sound; options are those of its `transcribe`."""
    from faster_whisper import WhisperModel

    plain = WhisperModel(str(path), device="cpu", compute_type="int8", cpu_threads=THREADS)

    def heard(samples: Samples, **options: object) -> str:
        found, _ = plain.transcribe(samples.astype(np.float32) / 32768, language="en", **options)
        return " ".join(segment.text for segment in found)

    return heard


def _ways(path: Path) -> dict[str, Callable[[Samples], str]]:
    heard = untouched(path)
    ours = Whisper(lambda _: path, threads=THREADS)

    return {
        DEFAULTS: heard,
        SAME: lambda samples: heard(
            samples,
            beam_size=1,
            temperature=0.0,
            without_timestamps=True,
            condition_on_previous_text=False,
        ),
        OURS: lambda samples: ours.transcribe(samples, "en").text,
    }
