"""The wake word by microWakeWord's small streaming networks, which a product may use (Apache-2.0).

A network is a pair of files: a JSON description, which has the phrase and its threshold, and the
weights beside it.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pymicro_wakeword import MicroWakeWord as Network
from pymicro_wakeword import MicroWakeWordFeatures

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import open_file, read_text
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.word_detection import KEPT_S, QUIET_S, OncePerWord, WakeSleep

CUTOFFS: Mapping[str, float] = {"alexa": 0.7}
"""By phrase, the likelihood from which on a network's phrase counts instead of from its own. Chosen
with 72 people's "alexa" that `benchmarks/hearing/people.py` does not report: the network's own 0.9
missed 2.8 % in quiet and 9.7 % in noise at 10 dB, 0.7 none and 2.8 %; other words reach 0.4."""
LARGEST_BYTES = 10_000_000
_TFLITE = b"TFL3"
"""The mark of a TensorFlow Lite file, from its fifth byte on."""


class _Micro(BaseModel):
    probability_cutoff: float = Field(gt=0.0, lt=1.0)
    sliding_window_size: int = Field(ge=1, le=100)


class _Description(BaseModel):
    """A network's JSON, as microWakeWord's training writes it."""

    model_config = ConfigDict(extra="ignore")

    wake_word: str = Field(min_length=1, max_length=100)
    model: str = Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*\.tflite$")
    micro: _Micro


class MicroWakeWord:
    """Implements `WakeDetector` by the network that a JSON file describes.

    `cutoff` is the likelihood from which on the phrase counts; the file's by default. Raises
    `InvalidValue` for files that are none.
    """

    def __init__(
        self, file: Path, *, cutoff: float | None = None, always_awake: bool = False
    ) -> None:
        said = _read(file)
        self.phrase = " ".join(said.wake_word.casefold().split())
        _check_weights(file.parent / said.model)
        self._network = Network.from_config(file)
        self._features = MicroWakeWordFeatures()
        self._cutoff = said.micro.probability_cutoff if cutoff is None else cutoff
        self._sleep = WakeSleep(always_awake=always_awake)
        self._once = OncePerWord(QUIET_S)
        self.likelihood = 0.0
        self.reset()

    def heard(self, samples: Samples, probability: float) -> bool:
        awake = self._sleep.push(samples, probability)
        self.likelihood = self._run(np.concatenate(awake)) if awake else 0.0
        return self._once.counts(self.likelihood > self._cutoff)

    def reset(self) -> None:
        self._sleep.reset()
        self._once.forget()
        self._run(np.zeros(round(KEPT_S * RATE_HZ), np.int16))
        self.likelihood = 0.0

    def close(self) -> None:
        self._network.close()

    def _run(self, samples: Samples) -> float:
        """The highest probability that the phrase ends in here."""
        found = (
            self._network.process_streaming_prob(features)
            for features in self._features.process_streaming(samples.tobytes())
        )
        return max((one or 0.0 for one in found), default=0.0)


def open_network(folder: Path, phrase: str) -> MicroWakeWord:
    """Open the network in a folder of ours that hears this phrase."""
    return MicroWakeWord(folder / f"{phrase.replace(' ', '_')}.json", cutoff=CUTOFFS.get(phrase))


def _read(file: Path) -> _Description:
    try:
        data: Any = json.loads(read_text(file, "wakeword"))
        return _Description.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "file"
        raise InvalidValue(f"wakeword {file.name}: {where}", "", first["msg"]) from None
    except (ValueError, RecursionError) as error:
        raise InvalidValue("wakeword", str(file), f"a file in JSON ({error})") from None


def _check_weights(weights: Path) -> None:
    """The library ends the process for a file that is none."""
    with open_file(weights, "wakeword", LARGEST_BYTES) as stream:
        if stream.read(8)[4:] != _TFLITE:
            raise InvalidValue("wakeword", str(weights), "a network in TensorFlow Lite's format")
