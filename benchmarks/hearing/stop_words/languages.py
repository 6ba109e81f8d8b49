"""Stop words by their sound in other languages: English ones, and the language's own.

Held-out speakers of espeak-ng and Kokoro's voices of the language, which spoke English in training,
say "Stop!" alone and after a name. The language's own stop words, and words that sound like them,
are said by ten of Kokoro's voices and 18 of espeak-ng's speakers, in held-out texts. False stops
are counted in sentences of the tests' corpora.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from corpus_sentences import read_corpus
from voice_rig import says

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.stop_words.ears import (
    LEAD_S,
    Ears,
    FalseStops,
    among,
    ears_of,
    false_stops,
    joined,
    trials,
)
from benchmarks.hearing.stop_words.english import HOURS, WANTED_FALSE
from benchmarks.hearing.stop_words.language_sounds import Said, said_in, tracks_of
from benchmarks.hearing.stop_words.sounds import LEVELS_DB, Track
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.languages import LANGUAGES
from edgevox.models import ModelMissing
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stop_spotter.network import read_language_weights, read_weights
from edgevox.voice.tts.voices import VoicePool
from training.acoustics import Half
from training.acoustics.clips import Clip, speak
from training.acoustics.languages import read_aloud
from training.acoustics.mixing import at_level
from training.acoustics.voices import espeak_speakers, say, trimmed

ENGLISH = "English stop words in other languages"
OWN = "Stop words of other languages"
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
HEARD = {"quiet": (None, "quiet"), "db10": (10.0, "10 dB, room"), "db5": (5.0, "5 dB, room")}
"""Signal to noise ratio, and its column, by which figure it is."""
SENTENCES, NATURAL = 60, 16
"""So many of each language are said by espeak-ng, and by its Kokoro's voices."""
PAUSE_S = 0.4
HALF = Half.HELD_OUT


@dataclass(frozen=True, slots=True)
class Language:
    """What is said in one: English stop words, and sentences without one."""

    code: str
    stops: Sequence[Samples]
    sentences: Sequence[tuple[str, Samples]]

    @property
    def name(self) -> str:
        return LANGUAGES[self.code].name


def measure(quick: bool = False) -> Measured:
    """Every language but English; a quick run takes a fifth of what is said."""
    pool, step = VoicePool(), 5 if quick else 1
    weights, known = read_weights(), read_language_weights()
    figures: list[Figure] = []
    told: list[FalseStops] = []
    try:
        for code in (code for code in LANGUAGES if code != "en"):
            ears = ears_of(weights, known.get(code))
            language = _said(code, step, pool)
            rng = np.random.default_rng(31)
            figures += _heard(ears, language, rng)
            told.append(_false_stops(ears, language, rng))
            figures.append(_false(ENGLISH, f"{code}.false", language.name, told[-1]))
        for code in known:
            ears = ears_of(weights, known[code])
            own, wrong = _own(ears, code, step)
            figures += own
            told.append(wrong)
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    hours, wrong = sum(one.hours for one in told), [note for one in told for note in one.wrong]
    figures.append(
        Figure(
            id="all.false", table=OWN, what=f"false stops in all, {hours:.2f} h of speech",
            column="false stops", value=len(wrong),
            wanted=round(WANTED_FALSE * hours / HOURS, 2),
        )
    )  # fmt: skip
    return Measured(figures=tuple(figures), notes={"taken for a stop": tuple(wrong)})


def _own(ears: Ears, code: str, step: int) -> tuple[list[Figure], FalseStops]:
    """How well the words of the language itself are heard, and what it stops for in it."""
    whole = said_in(code, HALF)
    said = Said(whole.words[::step], whole.alike[::step], whole.talk[::step])
    speak(said.clips, lambda _: None)
    name = LANGUAGES[code].name
    figures = [*_own_heard(ears, code, said.words)]
    alike = false_stops(ears, code, joined(tracks_of(said.alike, HALF)))
    figures.append(
        Figure.share(
            f"{code}.own.alike", OWN, name, len(alike.wrong), len(said.alike),
            column="alike, taken for one",
        )
    )  # fmt: skip
    talk = false_stops(ears, code, joined(tracks_of(said.talk, HALF)))
    figures.append(_false(OWN, f"{code}.own.false", name, talk))
    return figures, talk


def _own_heard(ears: Ears, code: str, words: Sequence[Clip]) -> Iterator[Figure]:
    for one, (snr_db, column) in HEARD.items():
        heard = [trial.heard for trial in trials(HALF, ears, words, snr_db)]
        yield Figure.share(
            f"{code}.own.{one}", OWN, LANGUAGES[code].name, sum(heard), len(heard),
            column=column, more_is_better=True,
        )  # fmt: skip


def _false(table: str, figure: str, name: str, told: FalseStops) -> Figure:
    return Figure(id=figure, table=table, what=name, column="false stops", value=len(told.wrong))


def _said(code: str, step: int, pool: VoicePool) -> Language:
    accent = ACCENTS.get(code, code)
    speakers = [f"espeak:{accent}+{person}" for person in espeak_speakers(HALF)][::step]
    natural = [one.name for one in LANGUAGES[code].voices if one.backend == "kokoro"]

    def naturally(name: str, text: str) -> Samples:
        return trimmed(says(code, name, text, pool))

    stop = STOP.get(code, "Stop!")
    both = (stop, NAMED.get(code, f"Robot, {stop.lstrip('¡')}"))
    stops = [say(one, read_aloud(text, code)) for one in speakers for text in both]
    stops += [naturally(one, text) for one in natural for text in both]
    corpus = (one.says for one in read_corpus() if one.language == code)
    free = [text for text in corpus if _is_free(code, text)]
    told = zip(itertools.cycle(speakers), free[: SENTENCES // step])
    sentences = [(text, say(one, read_aloud(text, code))) for one, text in told]
    # Few languages have natural voices; where there is none, nothing is cycled.
    more = zip(itertools.cycle(natural), free[: NATURAL // step])
    sentences += [(text, naturally(one, text)) for one, text in more]
    return Language(code, stops, sentences)


def _is_free(code: str, text: str) -> bool:
    return not (find_stop_word(code, text) or find_stop_word("en", text))


def _heard(ears: Ears, language: Language, rng: np.random.Generator) -> Iterator[Figure]:
    for one, (snr_db, column) in HEARD.items():
        sounds = [among(stop, HALF, snr_db, rng)[1] for stop in language.stops]
        hits = sum(any(when > LEAD_S for when in ears.stops(sound)) for sound in sounds)
        yield Figure.share(
            f"{language.code}.{one}", ENGLISH, language.name, hits, len(sounds),
            column=column, more_is_better=True,
        )  # fmt: skip


def _false_stops(ears: Ears, language: Language, rng: np.random.Generator) -> FalseStops:
    pause = np.zeros(int(PAUSE_S * RATE_HZ), np.int16)
    tracks = (
        Track(text, None, np.append(at_level(sound, rng.uniform(*LEVELS_DB)), pause))
        for text, sound in language.sentences
    )
    return false_stops(ears, language.code, joined(tracks))
