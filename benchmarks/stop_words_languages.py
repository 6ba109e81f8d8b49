"""English stop words where another language is spoken: they count there, too, and by their sound.

"Stop!" is said alone and after a name by speakers of espeak-ng in each language, who were held out
from the spotter's training, and by Kokoro's voices of the language, which spoke English in it. What
else is said are sentences of the tests' corpora that hold no stop word, of either language.
Nothing of other languages was learnt, and nothing was chosen with these sounds.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import shared_with_tests  # noqa: F401 - finds the tests' modules
from acoustics import Half
from acoustics.mixing import at_level, mixed
from acoustics.noises import kinds
from acoustics.rooms import in_room, rooms
from acoustics.voices import espeak_speakers, say, trimmed
from corpus_sentences import read_corpus
from figures import Figure, Measured, NotHere
from stop_words_ears import LEAD_S, TAIL_S, Ears, ears_of
from stop_words_sounds import LEVELS_DB, noise_of
from voice_engines import speak, voice

from edgevox.agent.safety import find_stop_word
from edgevox.core.languages import LANGUAGES
from edgevox.models import ModelMissing
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.resample import resampled
from edgevox.voice.stop_network import read_weights
from edgevox.voice.tts.pool import VoicePool

TABLE = "English stop words in other languages"
STOP = {"ar": "ستوب!", "hi": "स्टॉप!", "ja": "ストップ!", "ru": "Стоп!", "es": "¡Stop!"}
"""As it is written where its letters are others; elsewhere "Stop!"."""
NAMED = {
    "ar": "روبوت، ستوب!",
    "hi": "रोबोट, स्टॉप!",
    "ja": "ロボット、ストップ!",
    "ru": "Робот, стоп!",
}
"""The same after a name; elsewhere "Robot, stop!"."""
ACCENTS = {"zh": "cmn"}
"""What espeak-ng calls a language by another name."""
NOISE_DB = (None, 10.0)
SENTENCES, NATURAL = 60, 16
"""So many of each language are said by espeak-ng, and by its Kokoro's voices."""
PAUSE_S = 0.4
TOGETHER = 20


@dataclass(frozen=True, slots=True)
class Heard:
    """What came of one language: stop words, of so many, and false stops in so many hours."""

    quiet: int
    noise: int
    said: int
    false: int
    hours: float
    wrong: tuple[str, ...]


def measure(quick: bool = False) -> Measured:
    """Every language but English; a quick run takes a fifth of what is said."""
    ears, figures, wrong, hours = ears_of(read_weights()), [], [], 0.0
    try:
        for code in (code for code in LANGUAGES if code != "en"):
            found = _heard(ears, code, 5 if quick else 1)
            wrong += found.wrong
            hours += found.hours
            figures += _figures(code, found)
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    figures.append(
        Figure(
            id="all.false", table=TABLE, what=f"all of them, {hours:.2f} h of speech",
            column="false stops", value=len(wrong), wanted=round(hours / 4, 2),
        )
    )  # fmt: skip
    return Measured(figures=tuple(figures), notes={"taken for a stop": tuple(wrong)})


def _figures(code: str, found: Heard) -> Iterator[Figure]:
    for column, hits in (("heard in quiet", found.quiet), ("at 10 dB, room", found.noise)):
        name = f"{code}.{'quiet' if column == 'heard in quiet' else 'db10'}"
        yield Figure.share(
            name, TABLE, LANGUAGES[code].name, hits, found.said, column=column,
            more_is_better=True,
        )  # fmt: skip
    yield Figure(
        id=f"{code}.false", table=TABLE, what=LANGUAGES[code].name, column="false stops",
        value=found.false,
    )  # fmt: skip


def _heard(ears: Ears, code: str, step: int) -> Heard:
    rng = np.random.default_rng(31)
    accent = ACCENTS.get(code, code)
    speakers = [f"espeak:{accent}+{person}" for person in espeak_speakers(Half.HELD_OUT)][::step]
    stop = STOP.get(code, "Stop!")
    named = NAMED.get(code, f"Robot, {stop.lstrip('¡')}")
    clips = [say(one, text) for one in speakers for text in (stop, named)]
    natural = [one.name for one in LANGUAGES[code].voices if one.backend == "kokoro"]
    clips += [_natural(code, one, text) for one in natural for text in (stop, named)]
    heard = [sum(_stops(ears, _around(clip, snr, rng)) for clip in clips) for snr in NOISE_DB]
    corpus = (one.says for one in read_corpus() if one.language == code)
    said = [text for text in corpus if _is_free(code, text)]
    told = zip(itertools.cycle(speakers), said[: SENTENCES // step])
    spoken = [(text, say(one, text)) for one, text in told]
    if natural:
        more = zip(itertools.cycle(natural), said[: NATURAL // step])
        spoken += [(text, _natural(code, one, text)) for one, text in more]
    wrong, seconds = _false(ears, spoken, rng)
    return Heard(
        *heard, len(clips), len(wrong), seconds / 3600, tuple(f"{code}: {one}" for one in wrong)
    )


def _is_free(code: str, text: str) -> bool:
    return not (find_stop_word(code, text) or find_stop_word("en", text))


def _around(clip: Samples, snr_db: float | None, rng: np.random.Generator) -> Samples:
    """A clip with a second before it, in quiet or in a room with noise."""
    track = np.concatenate([np.zeros(int(LEAD_S * RATE_HZ)), clip, np.zeros(int(TAIL_S * RATE_HZ))])
    if snr_db is None:
        return at_level(track + rng.normal(0, 3, track.size), rng.uniform(*LEVELS_DB))
    responses, known = _responses(), kinds(Half.HELD_OUT)
    track = in_room(track, responses[rng.integers(len(responses))])[: track.size]
    noise = noise_of(known[rng.integers(len(known))], int(rng.integers(40)), Half.HELD_OUT)
    start = rng.integers(noise.size - track.size)
    return at_level(
        mixed(track, noise[start : start + track.size], snr_db), rng.uniform(*LEVELS_DB)
    )


@cache
def _responses() -> Sequence[np.ndarray]:
    return [room.response() for room in rooms(Half.HELD_OUT, 20)]


def _stops(ears: Ears, sound: Samples) -> bool:
    return any(when > LEAD_S for when in ears.stops(sound))


def _false(
    ears: Ears, spoken: Sequence[tuple[str, Samples]], rng: np.random.Generator
) -> tuple[list[str], float]:
    """The sentences at which it stopped, and how many seconds were heard."""
    wrong, seconds = [], 0.0
    pause = np.zeros(int(PAUSE_S * RATE_HZ), np.int16)
    for first in range(0, len(spoken), TOGETHER):
        some = spoken[first : first + TOGETHER]
        sounds = [np.append(at_level(sound, rng.uniform(*LEVELS_DB)), pause) for _, sound in some]
        ends = np.cumsum([sound.size for sound in sounds]) / RATE_HZ
        for when in ears.stops(np.concatenate(sounds)):
            number = min(int(np.searchsorted(ends, when)), len(some) - 1)
            wrong.append(f"{some[number][0]} (took it for {ears.word})")
        seconds += float(ends[-1])
    return wrong, seconds


@cache
def _pool() -> VoicePool:
    return VoicePool()


def _natural(code: str, name: str, text: str) -> Samples:
    chunks = speak(voice(code, name), text, _pool())
    return trimmed(np.concatenate([resampled(one.samples, one.rate_hz, RATE_HZ) for one in chunks]))
