"""Wake words, both engines: misses, false alarms, and the share of a core.

Kokoro's and espeak-ng's voices say the phrases in 60 calls, in quiet and in white noise at 10 dB.
False alarms are counted in the speech of `stop_words`: held-out voices of both, slower and faster,
three of five in a room. The engine that takes thirty times as much hears less of it.
"""

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from listener_rig import frames, says_espeak
from voice_rig import says

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.listening import quiet_room
from benchmarks.hearing.stop_words.ears import Stretch, joined
from benchmarks.hearing.stop_words.english import need
from benchmarks.hearing.stop_words.sounds import talk, tracks
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import FRAME_S, RATE_HZ, Samples
from edgevox.voice.tts.voices import VoicePool
from edgevox.voice.vad import open_vad
from edgevox.voice.wake.micro import open_network
from edgevox.voice.wake.wakeword import WakeWord
from edgevox.voice.word_detection import WakeDetector
from training.acoustics import Half

Judged = tuple[Samples, float]
TABLE = "Wake words"
PHRASES = ("hey jarvis", "alexa", "hey mycroft", "okay nabu")
KOKORO = (
    "af_heart", "af_bella", "af_nicole", "af_sky", "am_adam", "am_michael",
    "bf_emma", "bf_isabella", "bm_george", "bm_lewis",
)  # fmt: skip
ESPEAK = ("en-us", "en", "en-029", "en-gb-scotland", "en-gb-x-rp")
SNR_DB = 10.0
LEVEL = 0.05
OTHER_H = {"micro": 2.0, "openwakeword": 0.1}
"""Hours of speech without the phrases."""
ENGINES: dict[str, Callable[[str], WakeDetector]] = {
    "micro": lambda phrase: open_network(locate("micro-wake-words"), phrase),
    "openwakeword": lambda phrase: WakeWord(phrase, locate("wake-words")),
}
LABELS = {"micro": "microWakeWord (default)", "openwakeword": "openWakeWord"}


def measure(quick: bool = False) -> Measured:
    """Both engines on the same calls. Raises `NotHere` without its models or clips."""
    need(talk(Half.HELD_OUT))
    try:
        rng = np.random.default_rng(5)
        pool = VoicePool(len(KOKORO))
        calls = {phrase: list(_calls(phrase, pool, quick)) for phrase in PHRASES}
        said = {
            phrase: [(judged(sound), judged(_noisy(sound, rng))) for sound in sounds]
            for phrase, sounds in calls.items()
        }
        figures = [one for name in ENGINES for one in _of(name, said, quick)]
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=tuple(figures))


def _of(
    name: str, calls: dict[str, list[tuple[list[Judged], list[Judged]]]], quick: bool
) -> Iterator[Figure]:
    open_it, label = ENGINES[name], LABELS[name]

    def figure(identifier: str, column: str, value: float, unit: str) -> Figure:
        return Figure.of(f"{identifier}.{name}", TABLE, label, [value], unit, column=column)

    missed = {"quiet": 0, "noise": 0}
    for phrase, said in calls.items():
        detector = open_it(phrase)
        for quiet, noisy in said:
            missed["quiet"] += not is_heard(detector, quiet)
            missed["noise"] += not is_heard(detector, noisy)
        detector.close()
    number = sum(map(len, calls.values()))
    yield figure("missed_quiet", "missed, quiet", 100 * missed["quiet"] / number, "%")
    yield figure("missed_noise", "missed, noise at 10 dB", 100 * missed["noise"] / number, "%")
    alarms, hours, some = 0, 0.0, list[Judged]()
    detectors = [open_it(phrase) for phrase in PHRASES]
    for stretch in _without_the_phrases(OTHER_H[name] / (20 if quick else 1)):
        frames_of = judged(stretch.sound)
        some = some or frames_of
        alarms += sum(is_heard(detector, frames_of) for detector in detectors)
        hours += stretch.hours
    yield figure("false_alarms", "false alarms of four phrases", alarms, "")
    yield figure("other_speech", "of speech without them", hours, "h")
    for column, sound in (
        ("silence", judged(quiet_room(60.0))),
        ("speech", some[: round(60 / FRAME_S)]),
    ):
        yield figure(f"share_{column}", f"of a core, {column}", _share(detectors[0], sound), "%")
    for detector in detectors:
        detector.close()


def _without_the_phrases(hours: float) -> Iterator[Stretch]:
    """Speech in which nobody says a phrase or the name in it."""
    names = [phrase.split()[-1] for phrase in PHRASES]
    return joined(
        track
        for track in tracks(Half.HELD_OUT, "speech", 3600 * hours)
        if not any(name in track.note.casefold() for name in names)
    )


def is_heard(detector: WakeDetector, sound: Sequence[Judged]) -> int:
    """How often a detector, reset before, hears its phrase in a sound."""
    detector.reset()
    return sum(detector.heard(samples, probability) for samples, probability in sound)


def _share(detector: WakeDetector, sound: Sequence[Judged]) -> float:
    """Percent of a core that it takes beside the voice detector, which always runs."""
    began = time.process_time()
    is_heard(detector, sound)
    return 100 * (time.process_time() - began) / (len(sound) * FRAME_S)


def judged(sound: Samples) -> list[Judged]:
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
