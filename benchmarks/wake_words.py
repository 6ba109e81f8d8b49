"""Wake words, both engines side by side: misses, false alarms an hour, and the share of a core.

Kokoro's and espeak-ng's voices say the phrases, quiet and in noise 10 dB below them. What is not
the phrase is read by espeak-ng, from the corpus of tests: how much of it is told as a figure.
"""

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import shared_with_tests  # noqa: F401 - finds the tests' modules
import yaml
from figures import Figure, Measured, NotHere
from listener_rig import frames, says_espeak
from listening import quiet_room
from voice_rig import says

from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import FRAME_S, RATE_HZ, Samples
from edgevox.voice.foreground import open_vad
from edgevox.voice.microwakeword import MicroWakeWord
from edgevox.voice.resample import resampled
from edgevox.voice.tts.pool import VoicePool
from edgevox.voice.wakeword import WakeDetector, WakeWord

Judged = tuple[Samples, float]
TABLE = "Wake words"
CORPUS = Path(__file__).resolve().parents[1] / "tests" / "corpus"
PHRASES = ("hey jarvis", "alexa", "hey mycroft", "okay nabu")
KOKORO = (
    "af_heart", "af_bella", "af_nicole", "af_sky", "am_adam", "am_michael",
    "bf_emma", "bf_isabella", "bm_george", "bm_lewis",
)  # fmt: skip
ESPEAK = ("en-us", "en", "en-029", "en-gb-scotland", "en-gb-x-rp")
SNR_DB = 10.0
LEVEL = 0.05
OTHER_S = 1200.0
LANGUAGES = ("en", "de", "fr", "es", "it", "nl", "pt")
ENGINES: dict[str, Callable[[str], WakeDetector]] = {
    "micro": lambda phrase: MicroWakeWord(
        locate("micro-wake-words") / f"{phrase.replace(' ', '_')}.json"
    ),
    "openwakeword": lambda phrase: WakeWord(phrase, locate("wake-words")),
}
LABELS = {"micro": "microWakeWord (default)", "openwakeword": "openWakeWord"}


def measure(quick: bool = False) -> Measured:
    """Both engines on the same sounds."""
    try:
        rng = np.random.default_rng(5)
        pool = VoicePool(len(KOKORO))
        calls = {phrase: list(_calls(phrase, pool, quick)) for phrase in PHRASES}
        said = {
            phrase: [(_judged(sound), _judged(_noisy(sound, rng))) for sound in sounds]
            for phrase, sounds in calls.items()
        }
        other = _judged(np.concatenate(list(_others(120.0 if quick else OTHER_S))))
        figures = [one for name in ENGINES for one in _of(name, said, other)]
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=tuple(figures))


def _of(
    name: str, calls: dict[str, list[tuple[list[Judged], list[Judged]]]], other: list[Judged]
) -> Iterator[Figure]:
    open_it = ENGINES[name]

    def figure(identifier: str, column: str, value: float, unit: str, **more: object) -> Figure:
        return Figure.of(
            f"{identifier}.{name}", TABLE, LABELS[name], [value], unit, column=column, **more
        )

    missed = {"quiet": 0, "noise": 0}
    for phrase, said in calls.items():
        detector = open_it(phrase)
        for quiet, noisy in said:
            missed["quiet"] += not _heard(detector, quiet)
            missed["noise"] += not _heard(detector, noisy)
        detector.close()
    number = sum(map(len, calls.values()))
    yield figure("missed_quiet", "missed, quiet", 100 * missed["quiet"] / number, "%")
    yield figure("missed_noise", "missed, noise at 10 dB", 100 * missed["noise"] / number, "%")
    hours = len(other) * FRAME_S / 3600
    alarms = 0
    for phrase in PHRASES:
        detector = open_it(phrase)
        alarms += _heard(detector, other)
        detector.close()
    yield figure(
        "false_alarms", "false alarms an hour, each phrase", alarms / hours / len(PHRASES), ""
    )
    yield figure("other_speech", "of speech without it", hours, "h")
    detector = open_it(PHRASES[0])
    for column, sound in (
        ("silence", _judged(quiet_room(60.0))),
        ("speech", other[: round(60 / FRAME_S)]),
    ):
        yield figure(f"share_{column}", f"of a core, {column}", _share(detector, sound), "%")
    detector.close()


def _heard(detector: WakeDetector, sound: Sequence[Judged]) -> int:
    detector.reset()
    return sum(detector.heard(samples, probability) for samples, probability in sound)


def _share(detector: WakeDetector, sound: Sequence[Judged]) -> float:
    """Percent of a core that it takes beside the voice detector, which always runs."""
    began = time.process_time()
    _heard(detector, sound)
    return 100 * (time.process_time() - began) / (len(sound) * FRAME_S)


def _judged(sound: Samples) -> list[Judged]:
    """Its frames, each with its probability of voice."""
    vad = open_vad()
    return [(frame.samples, vad.probability(frame.samples)) for frame in frames(sound)]


def _calls(phrase: str, pool: VoicePool, quick: bool) -> Iterator[Samples]:
    for name in KOKORO[: 2 if quick else None]:
        yield _in_a_room(says("en", name, f"{phrase}.", pool))
    for language in ESPEAK[: 1 if quick else None]:
        yield _in_a_room(says_espeak(phrase, language))


def _in_a_room(said: Samples) -> Samples:
    wide = said.astype(np.float64)
    level = LEVEL * 32768 / np.sqrt(np.mean(wide**2))
    room = np.concatenate([np.zeros(2 * RATE_HZ), wide * level, np.zeros(RATE_HZ)])
    rng = np.random.default_rng(7)
    return np.clip(room + rng.normal(0, 10, room.size), -32767, 32767).astype(np.int16)


def _noisy(sound: Samples, rng: np.random.Generator) -> Samples:
    noise = rng.normal(0, LEVEL * 32768 * 10 ** (-SNR_DB / 20), sound.size)
    return np.clip(sound + noise, -32767, 32767).astype(np.int16)


def _others(seconds: float) -> Iterator[Samples]:
    """Sentences of the corpus, faster and slower, until it is enough."""
    made = 0
    for speed, (code, text) in itertools.product((16000, 15000, 17200, 18200), list(_sentences())):
        if made >= seconds * RATE_HZ:
            return
        one = resampled(says_espeak(text, code), speed, RATE_HZ)
        made += one.size + RATE_HZ // 4
        yield np.append(one, np.zeros(RATE_HZ // 4, np.int16))


def _sentences() -> Iterator[tuple[str, str]]:
    for file in sorted(CORPUS.glob("*.yaml")):
        if (code := file.stem.split("_")[0]) in LANGUAGES:
            yield from (
                (code, text) for text in _said(list(yaml.safe_load_all(file.read_text("utf-8"))))
            )


def _said(node: object) -> Iterator[str]:
    if isinstance(node, dict):
        if isinstance(text := node.get("says"), str):
            yield text
        for value in node.values():
            yield from _said(value)
    elif isinstance(node, list):
        for value in node:
            yield from _said(value)
