"""Voice prints: tells the people who were enrolled from all others, by the sound of their voice.

A voice print is the mean of three sentences as Resemblyzer's encoder sees them: a network of 1.4
million weights, run in numpy. **It is no lock**: a recording, an imitation or a similar voice is
taken for the person, and a cold, a whisper or noise hides them.

Prints are biometric data of people. They are files that only their owner may read, one a person,
and leave the robot only where somebody copies them.
"""

import json
import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.state_files import StateFiles, write_atomically
from edgevox.core.log import get_logger, worth_a_line
from edgevox.voice.audio import FULL_SCALE, RATE_HZ, Samples

log = get_logger(__name__)

Floats = NDArray[np.float32]

ENCODER = "resemblyzer"
"""The id of the network in edgevox-models."""
ALIKE = 0.76
"""The likeness, at most 1, from which a voice is that of a print. Chosen with half of the people
of the benchmark `voiceprints`."""
SAME = 0.65
"""The least likeness of the sentences of an enrolment to each other: below it, two people spoke, or
noise hid the voice."""
SENTENCES = 3
LEAST_S = 1.0
"""A shorter utterance, without its pauses, tells too little of a voice."""
JUST_NOW_S = 10.0
"""Such an utterance is taken for that of the person who was recognised so short a time ago: "yes"
is shorter than any voice needs."""
MOST_NAME = 40

_HOP, _WINDOW = RATE_HZ // 100, RATE_HZ // 40
_BANDS, _UNITS, _LAYERS = 40, 256, 3
_PART, _STEP = 160, 77
"""Frames of 10 ms that the network sees at once, and from the beginning of one part to the next."""
_LEAST_PART = 0.75
"""So much of its last part must be filled, unless it is the only one."""
_LEVEL_DB = -30.0
"""Quieter speech is made so loud, in dB of full scale, as what the network was trained with."""
_PIECE = RATE_HZ // 50
_QUIETER_DB = 30.0
"""Pieces of 20 ms that are this much below the loudest are pauses, and are left out."""
_AROUND = 11
"""Pieces around each one with speech that are kept."""


class VoiceEncoder:
    """Turns speech into a vector of length 1 that is much the same for all speech of one person.

    `weights` is the file of `ENCODER`. It is a pickle for PyTorch, and is not read as one: the
    numbers lie at known places of a file whose checksum is known.
    """

    def __init__(self, weights: Path) -> None:
        self._file = weights

    def of(self, sound: Samples) -> Floats | None:
        """The vector of some speech at 16 kHz; None if it is shorter than `LEAST_S`.

        Takes some 35 ms of a core for each second. Raises `EdgeVoxError` without the weights.
        """
        speech = _without_pauses(sound.astype(np.float32) / FULL_SCALE)
        if speech.size < LEAST_S * RATE_HZ:
            return None
        return mean_of(self._run(_parts(speech)))

    def _run(self, x: Floats) -> Floats:
        """The network: `x` is (parts, frames, bands), the result (parts, units)."""
        lstm, linear, bias = self._weights
        for inner, recurrent, add in lstm:
            gates, out = x @ inner + add, np.empty((*x.shape[:2], _UNITS), np.float32)
            h = c = np.zeros((x.shape[0], _UNITS), np.float32)
            for frame in range(x.shape[1]):
                i, f, new, o = np.split(gates[:, frame] + h @ recurrent, 4, axis=1)
                c = _sigmoid(f) * c + _sigmoid(i) * np.tanh(new)
                h = out[:, frame] = _sigmoid(o) * np.tanh(c)
            x = out
        return _of_length_1(np.maximum(x[:, -1] @ linear + bias, 0))

    @cached_property
    def _weights(self) -> tuple[list[tuple[Floats, Floats, Floats]], Floats, Floats]:
        """For each layer the two matrices and the bias, then those of the last, linear one."""
        try:
            data = self._file.read_bytes()
            flat = np.frombuffer(data, "<f4", 1_357_824, 269_883)
            linear = np.frombuffer(data, "<f4", _UNITS * _UNITS, 7_731).reshape(_UNITS, _UNITS)
            bias = np.frombuffer(data, "<f4", _UNITS, 6_699)
        except (OSError, ValueError) as error:
            raise EdgeVoxError(f"voice prints: {self._file}: {error}") from error
        lstm, at, rows = [], 0, 4 * _UNITS
        biases = flat[-_LAYERS * 2 * rows :].reshape(_LAYERS, 2, rows)
        for layer in range(_LAYERS):
            both = []
            for columns in (_BANDS if layer == 0 else _UNITS, _UNITS):
                size = rows * columns
                both.append(np.ascontiguousarray(flat[at : at + size].reshape(rows, columns).T))
                at += size
            lstm.append((*both, biases[layer].sum(axis=0)))
        return [(a, b, c) for a, b, c in lstm], np.ascontiguousarray(linear.T), bias


class VoicePrints:
    """The prints in a folder, one file a person. Another process may change them at any time."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._files = StateFiles()
        self._seen: object = None
        self._known: dict[str, Floats] = {}

    @property
    def fault(self) -> str:
        """The files that could not be used; empty if none."""
        return self._files.fault

    def read(self) -> dict[str, Floats]:
        """The prints by name, as they are now. Raises `OSError` for a folder that is not read."""
        seen = self._stamp()
        if seen != self._seen:
            found = {_name(one): self._files.read(one, _print, secret=True) for one in self._paths}
            self._known = {name: one for name, one in found.items() if one is not None}
            self._seen = seen
        return self._known

    def keep(self, name: str, sentences: Sequence[Floats]) -> None:
        """Enrol a person by the vectors of some sentences, or enrol them again.

        Raises `InvalidValue` for a name that is none, and for sentences that are not one voice's.
        """
        least = min((float(one @ other) for one in sentences for other in sentences), default=0.0)
        if len(sentences) < SENTENCES or least < SAME:
            wanted = f"{SENTENCES} sentences of one voice, alike by at least {SAME}"
            raise InvalidValue("voice print", f"alike by {least:.2f}", wanted)
        path = self._path(name)
        self._files.make_folder(self._folder)
        write_atomically(path, json.dumps([round(float(x), 5) for x in mean_of(sentences)]))

    def forget(self, name: str) -> bool:
        """Delete a person's print; False if there is none. Raises `InvalidValue`, `OSError`."""
        path = self._path(name)
        there = path.exists()
        path.unlink(missing_ok=True)
        return there

    def _path(self, name: str) -> Path:
        plain = name.strip().casefold()
        if not plain or len(plain) > MOST_NAME or not plain.replace("-", "").isalnum():
            wanted = f"a name of letters, digits and hyphens, at most {MOST_NAME}"
            raise InvalidValue("voice print", name, wanted)
        return self._folder / f"{plain}.json"

    @property
    def _paths(self) -> list[Path]:
        return sorted(self._folder.glob("*.json"))

    def _stamp(self) -> object:
        """Changes with any of the files."""
        return [(one, one.stat().st_mtime_ns, one.stat().st_ino) for one in self._paths]


class KnownVoices:
    """Tells who speaks. Used from one thread."""

    def __init__(self, encoder: VoiceEncoder, prints: VoicePrints) -> None:
        self._encoder = encoder
        self._prints = prints
        self._last: tuple[str, float] = "", -math.inf
        self.failed = 0
        """Utterances that could not be judged; they count as a guest's."""

    def who(self, sound: Samples, ended_s: float) -> str:
        """The name of the person who said this, until that time of the clock; empty for a guest.

        All are guests where it is unknown. Never raises.
        """
        try:
            name = self._who(sound, ended_s)
        except Exception:
            self.failed += 1
            if worth_a_line(self.failed):
                log.exception("voice_unjudged", failed=self.failed)
            return ""
        return name

    def _who(self, sound: Samples, ended_s: float) -> str:
        prints = self._prints.read()
        if not prints:
            return ""
        heard = self._encoder.of(sound)
        if heard is None:
            last, at_s = self._last
            return last if last in prints and ended_s - at_s <= JUST_NOW_S else ""
        name, likeness = max(
            ((name, float(heard @ one)) for name, one in prints.items()), key=lambda one: one[1]
        )
        name = name if likeness >= ALIKE else ""
        self._last = name, ended_s
        return name


def mean_of(vectors: Sequence[Floats] | Floats) -> Floats:
    """The mean of some vectors, of length 1."""
    return _of_length_1(np.mean(vectors, axis=0))


def _of_length_1(vectors: Floats) -> Floats:
    """Each row of an array, or the only one, at length 1."""
    found: Floats = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return found


def _without_pauses(sound: Floats) -> Floats:
    pieces = sound[: sound.size // _PIECE * _PIECE].reshape(-1, _PIECE)
    power = np.mean(np.square(pieces), axis=1) if len(pieces) else np.zeros(1, np.float32)
    if not power.any():
        return np.zeros(0, np.float32)
    loud = power > power.max() * 10 ** (-_QUIETER_DB / 10)
    speech = pieces[np.convolve(loud, np.ones(_AROUND), "same") > 0.5].ravel()
    gain = 10 ** (_LEVEL_DB / 20) / np.sqrt(np.mean(np.square(speech)))
    quiet: Floats = speech * np.float32(max(1.0, gain))
    return quiet


def _parts(speech: Floats) -> Floats:
    """What the network sees: parts of 1.6 s that overlap, each of 160 frames of 40 bands."""
    frames = math.ceil((speech.size + 1) / _HOP)
    starts = list(range(0, max(1, frames - _PART + _STEP + 1), _STEP))
    filled = (speech.size - starts[-1] * _HOP) / (_PART * _HOP)
    if len(starts) > 1 and filled < _LEAST_PART:
        starts.pop()
    whole = (starts[-1] + _PART) * _HOP
    padded = np.pad(speech, (_WINDOW // 2, max(0, whole - speech.size) + _WINDOW // 2))
    windows = np.lib.stride_tricks.sliding_window_view(padded, _WINDOW)[::_HOP]
    power = np.abs(np.fft.rfft(windows * np.hanning(_WINDOW + 1)[:-1], axis=1)) ** 2
    bands = (power @ _MEL.T).astype(np.float32)
    return np.stack([bands[start : start + _PART] for start in starts])


def _mel() -> NDArray[np.float64]:
    """Slaney's mel bands, (bands, bins): linear to 1 kHz, then logarithmic, of equal area."""
    per_hz, knee_hz, step = 3 / 200, 1000.0, math.log(6.4) / 27
    knee = knee_hz * per_hz
    top = knee + math.log(RATE_HZ / 2 / knee_hz) / step
    mels = np.linspace(0, top, _BANDS + 2)
    edges = np.where(mels < knee, mels / per_hz, knee_hz * np.exp(step * (mels - knee)))
    bins = np.fft.rfftfreq(_WINDOW, 1 / RATE_HZ)
    widths = np.diff(edges)[:, None]
    slopes = bins[None] - edges[:, None]
    found = np.minimum(slopes[:-2] / widths[:-1], -slopes[2:] / widths[1:])
    return np.maximum(0, found) * (2 / (edges[2:] - edges[:-2]))[:, None]


_MEL = _mel()


def _sigmoid(x: Floats) -> Floats:
    found: Floats = 0.5 * (np.tanh(0.5 * x) + 1.0)
    return found


def _name(path: Path) -> str:
    return path.stem


def _print(text: str) -> Floats:
    found: Floats = np.asarray(json.loads(text), np.float32)
    if found.shape != (_UNITS,) or not np.isfinite(found).all() or not found.any():
        raise ValueError(f"expected {_UNITS} numbers")
    return _of_length_1(found)
