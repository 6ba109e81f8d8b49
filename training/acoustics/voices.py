"""What voices say, synthesised once and kept outside the repository.

The cache is `~/.cache/edgevox/acoustics`, or what the environment variable EDGEVOX_ACOUSTICS names:
one npz a text and voice. Kokoro takes as many threads as there are cores for this process, two at
most (`taskset -c 0` leaves it one).
"""

import functools
import hashlib
import os
import subprocess
from pathlib import Path

import numpy as np

from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.wav import resampled
from training.acoustics import Half

CACHE = Path(os.environ.get("EDGEVOX_ACOUSTICS", "~/.cache/edgevox/acoustics")).expanduser()
PIPER = "piper:joe"
"""The voice that the robot itself has by default; only ever trained with."""

_KOKORO_HELD_OUT = (
    "af_nova", "af_sarah", "am_eric", "am_onyx", "am_puck", "bf_lily", "bm_george", "hf_beta",
    "im_nicola", "zm_yunxi",
)  # fmt: skip
_KOKORO_TUNING = (
    "af_kore", "af_river", "am_fenrir", "am_liam", "bf_alice", "ef_dora", "jm_kumo", "zf_xiaoyi",
)  # fmt: skip
_ESPEAK_ACCENTS = ("en-us", "en-gb", "en-gb-scotland", "en-gb-x-rp", "en-029", "en-gb-x-gbclan")
_ESPEAK_PEOPLE = (
    "m1", "m2", "m3", "m4", "m5", "m6", "m7", "m8", "f1", "f2", "f3", "f4", "f5", "Alex", "Alicia",
    "Andrea", "Andy", "Annie", "adam", "aunty", "belinda", "benjamin", "boris", "caleb", "david",
    "ed", "edward", "grandma", "grandpa", "Gene", "Henrique", "Hugo", "iven2", "john", "linda",
    "Lee", "Marco", "mario", "max", "Michael", "michel", "miguel", "mike", "norbert", "paul",
    "pedro", "quincy", "rob", "robert", "steph", "travis", "victor", "zac", "shelby",
)  # fmt: skip
_ESPEAK_RATE_HZ = 22_050
_HEADER_BYTES = 44


def kokoro_voices(half: Half) -> tuple[str, ...]:
    """Kokoro's voices, as names for `say`; those of other languages have an accent."""
    if half is Half.HELD_OUT:
        return tuple(f"kokoro:{name}" for name in _KOKORO_HELD_OUT)
    if half is Half.TUNING:
        return tuple(f"kokoro:{name}" for name in _KOKORO_TUNING)
    files = sorted((locate("kokoro-voices") / "voices").glob("*.bin"))
    others = (*_KOKORO_HELD_OUT, *_KOKORO_TUNING)
    return tuple(f"kokoro:{f.stem}" for f in files if f.stem not in others)


def native_voices(half: Half) -> tuple[str, ...]:
    """Those of Kokoro's voices whose language is English: of America (a) and of Britain (b)."""
    return tuple(one for one in kokoro_voices(half) if one.partition(":")[2][0] in "ab")


def espeak_voices(half: Half) -> tuple[str, ...]:
    """espeak-ng's speakers and accents: every third speaker is held out, with all accents, and
    every sixth tunes.
    """
    people = espeak_speakers(half)
    return tuple(f"espeak:{accent}+{person}" for person in people for accent in _ESPEAK_ACCENTS)


def espeak_speakers(half: Half) -> tuple[str, ...]:
    """espeak-ng's names of those who speak any of its languages."""
    return tuple(one for i, one in enumerate(_ESPEAK_PEOPLE) if _half_of_speaker(i) is half)


def _half_of_speaker(number: int) -> Half:
    if number % 3 == 2:
        return Half.HELD_OUT
    return Half.TUNING if number % 6 == 1 else Half.TRAIN


def say(
    voice: str,
    text: str,
    *,
    speed: float = 1.0,
    pitch: int = 50,
    words_a_minute: int = 175,
    keep: bool = True,
) -> Samples:
    """What a voice says, at 16 kHz, without silence around it.

    Any of Kokoro's voices reads another language, with its accent, as ``kokoro:af_heart@fr``. Pitch
    and words a minute are espeak-ng's alone, `speed` is Kokoro's: how many times as fast as usual.
    It is cached only if it is to `keep`.
    """
    file = _file(voice, text, speed, pitch, words_a_minute)
    if file.exists():
        with np.load(file) as kept:
            return kept["samples"]
    engine, _, name = voice.partition(":")
    if engine == "kokoro":
        sound = _kokoro(name, text, speed)
    elif engine == "espeak":
        sound = _espeak(name, text, pitch, words_a_minute)
    else:
        sound = _piper(text)
    sound = trimmed(sound)
    if not keep:
        return sound
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(f".{os.getpid()}.npz")
    np.savez(part, samples=sound)
    part.replace(file)
    return sound


def is_cached(
    voice: str, text: str, *, speed: float = 1.0, pitch: int = 50, words_a_minute: int = 175
) -> bool:
    """Whether `say` has this by now."""
    return _file(voice, text, speed, pitch, words_a_minute).exists()


def _file(voice: str, text: str, speed: float, pitch: int, words_a_minute: int) -> Path:
    engine, options = voice.split(":", maxsplit=1)[0], ""
    if engine == "espeak":
        options = f"|{pitch}|{words_a_minute}"
    elif engine == "kokoro" and speed != 1:
        options = f"|{speed}"
    digest = hashlib.sha256(f"{voice}|{text}{options}".encode()).hexdigest()[:24]
    return CACHE / engine / f"{digest}.npz"


def trimmed(sound: Samples, floor_db: float = -40.0) -> Samples:
    """Without what is softer than `floor_db` below the loudest 10 ms, before and after."""
    step = RATE_HZ // 100
    whole = sound[: sound.size // step * step].astype(np.float64).reshape(-1, step)
    power = np.mean(whole**2, axis=1)
    heard = np.flatnonzero(power > power.max(initial=0) * 10 ** (floor_db / 10))
    if not heard.size:
        return sound[:0]
    return sound[heard[0] * step : (heard[-1] + 1) * step]


@functools.cache
def _kokoro_model():
    from edgevox.voice.tts.kokoro import KokoroModel

    return KokoroModel(locate("kokoro-82m"))


@functools.cache
def _kokoro_style(name: str):
    from edgevox.voice.tts.kokoro import load_style

    return load_style(locate("kokoro-voices"), name)


def _kokoro(name: str, text: str, speed: float) -> Samples:
    from edgevox.voice.tts.kokoro import SAMPLE_RATE_HZ
    from edgevox.voice.tts.synthesiser import to_samples

    model = _kokoro_model()
    name, _, language = name.partition("@")
    read_as = language or ("b" if name.startswith("b") else "a")  # by its first letter
    tokens = model.phonemes.tokens(text, read_as)
    sound = model.run(tokens, _kokoro_style(name), speed)
    return resampled(to_samples(sound), SAMPLE_RATE_HZ, RATE_HZ)


def _espeak(name: str, text: str, pitch: int, words_a_minute: int) -> Samples:
    command = [
        "espeak-ng",
        "-v",
        name,
        "-p",
        str(pitch),
        "-s",
        str(words_a_minute),
        "--stdout",
        text,
    ]
    out = subprocess.run(command, capture_output=True, check=True).stdout
    return resampled(np.frombuffer(out[_HEADER_BYTES:], np.int16), _ESPEAK_RATE_HZ, RATE_HZ)


@functools.cache
def _piper_voice():
    from piper import PiperVoice

    return PiperVoice.load(locate("piper-en_US-joe-medium"))


def _piper(text: str) -> Samples:
    chunks = list(_piper_voice().synthesize(text))
    sound = np.concatenate([chunk.audio_int16_array for chunk in chunks])
    return resampled(sound, chunks[0].sample_rate, RATE_HZ)
