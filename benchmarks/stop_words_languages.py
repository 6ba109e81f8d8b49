"""English stop words where another language is spoken: they count there, too, and by their sound.

"Stop!" is said alone and after a name by speakers of espeak-ng in each language, who were held out
from the spotter's training, and by Kokoro's voices of the language, which spoke English in it. What
else is said are sentences of the tests' corpora that hold no stop word, of either language.
Nothing of other languages was learnt, and nothing was chosen with these sounds.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shared_with_tests  # noqa: F401 - finds the tests' modules
from acoustics import Half
from acoustics.mixing import at_level
from acoustics.voices import espeak_speakers, say, trimmed
from corpus_sentences import read_corpus
from figures import Figure, Measured, NotHere
from stop_words import HOURS, WANTED_FALSE
from stop_words_ears import LEAD_S, Ears, FalseStops, among, ears_of, false_stops, joined
from stop_words_sounds import LEVELS_DB, Track
from voice_rig import says

from edgevox.agent.safety import find_stop_word
from edgevox.core.languages import LANGUAGES
from edgevox.models import ModelMissing
from edgevox.voice.audio import RATE_HZ, Samples
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
HEARD = {"quiet": (None, "heard in quiet"), "db10": (10.0, "at 10 dB, room")}
"""Signal to noise ratio, and its column, by which figure it is."""
SENTENCES, NATURAL = 60, 16
"""So many of each language are said by espeak-ng, and by its Kokoro's voices."""
PAUSE_S = 0.4
HALF = Half.HELD_OUT


@dataclass(frozen=True, slots=True)
class Language:
    """What is said in one: its stop words, and sentences without one."""

    code: str
    stops: Sequence[Samples]
    sentences: Sequence[tuple[str, Samples]]


def measure(quick: bool = False) -> Measured:
    """Every language but English; a quick run takes a fifth of what is said."""
    ears, pool = ears_of(read_weights()), VoicePool()
    figures: list[Figure] = []
    told: list[FalseStops] = []
    try:
        for code in (code for code in LANGUAGES if code != "en"):
            language = _said(code, 5 if quick else 1, pool)
            rng = np.random.default_rng(31)
            figures += _heard(ears, language, rng)
            told.append(_false_stops(ears, language, rng))
            figures.append(
                Figure(
                    id=f"{code}.false", table=TABLE, what=LANGUAGES[code].name,
                    column="false stops", value=len(told[-1].wrong),
                )
            )  # fmt: skip
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    hours, wrong = sum(one.hours for one in told), [note for one in told for note in one.wrong]
    figures.append(
        Figure(
            id="all.false", table=TABLE, what=f"all of them, {hours:.2f} h of speech",
            column="false stops", value=len(wrong),
            wanted=round(WANTED_FALSE * hours / HOURS, 2),
        )
    )  # fmt: skip
    return Measured(figures=tuple(figures), notes={"taken for a stop": tuple(wrong)})


def _said(code: str, step: int, pool: VoicePool) -> Language:
    accent = ACCENTS.get(code, code)
    speakers = [f"espeak:{accent}+{person}" for person in espeak_speakers(HALF)][::step]
    natural = [one.name for one in LANGUAGES[code].voices if one.backend == "kokoro"]

    def naturally(name: str, text: str) -> Samples:
        return trimmed(says(code, name, text, pool))

    stop = STOP.get(code, "Stop!")
    both = (stop, NAMED.get(code, f"Robot, {stop.lstrip('¡')}"))
    stops = [say(one, text) for one in speakers for text in both]
    stops += [naturally(one, text) for one in natural for text in both]
    corpus = (one.says for one in read_corpus() if one.language == code)
    free = [text for text in corpus if _is_free(code, text)]
    told = zip(itertools.cycle(speakers), free[: SENTENCES // step])
    sentences = [(text, say(one, text)) for one, text in told]
    # Few languages have natural voices; where there is none, nothing is cycled.
    more = zip(itertools.cycle(natural), free[: NATURAL // step])
    sentences += [(text, naturally(one, text)) for one, text in more]
    return Language(code, stops, sentences)


def _is_free(code: str, text: str) -> bool:
    return not (find_stop_word(code, text) or find_stop_word("en", text))


def _heard(ears: Ears, language: Language, rng: np.random.Generator) -> Iterator[Figure]:
    for name, (snr_db, column) in HEARD.items():
        sounds = [among(stop, HALF, snr_db, rng)[1] for stop in language.stops]
        hits = sum(any(when > LEAD_S for when in ears.stops(sound)) for sound in sounds)
        yield Figure.share(
            f"{language.code}.{name}", TABLE, LANGUAGES[language.code].name, hits, len(sounds),
            column=column, more_is_better=True,
        )  # fmt: skip


def _false_stops(ears: Ears, language: Language, rng: np.random.Generator) -> FalseStops:
    pause = np.zeros(int(PAUSE_S * RATE_HZ), np.int16)
    tracks = (
        Track(text, None, np.append(at_level(sound, rng.uniform(*LEVELS_DB)), pause))
        for text, sound in language.sentences
    )
    return false_stops(ears, language.code, joined(tracks))
