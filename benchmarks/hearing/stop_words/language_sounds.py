"""What is said in languages other than English, to choose thresholds with and to test with."""

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from corpus_sentences import read_corpus

from benchmarks.hearing.stop_words.sounds import (
    Track,
    at_speed,
    before_a_pause,
    in_noise,
    responses,
)
from training.acoustics import Half
from training.acoustics.clips import Clip, espeak_manner
from training.acoustics.languages import (
    espeak_speakers_of,
    has_none,
    is_native,
    kokoro_speakers,
    read_aloud,
    texts,
)
from training.acoustics.rooms import in_room

SENTENCES = {"kokoro": 12, "espeak": 120}
"""Of a language, without a stop word, by engine."""
_IN_A_ROOM, _IN_NOISE = 0.6, 0.25


@dataclass(frozen=True, slots=True)
class Said:
    """Clips of one part in one language: stop words, and what is none."""

    words: Sequence[Clip]
    alike: Sequence[Clip]
    talk: Sequence[Clip]

    @property
    def clips(self) -> list[Clip]:
        return [*self.words, *self.alike, *self.talk]


def said_in(language: str, half: Half) -> Said:
    """By this part's voices of Kokoro, most with an accent, and speakers of espeak-ng."""
    rng, known = random.Random(f"{language} {half}"), texts(language, half)
    natural = kokoro_speakers(language, half)
    speakers: dict[str, list[str]] = {}
    for voice in espeak_speakers_of(language, half):
        speakers.setdefault(voice.partition("+")[2], []).append(voice)
    ends = [[(text, word) for text in some] for word, some in known.ends.items()]
    words, alike = [], []
    for voice in natural:
        for some in ends:
            chosen = some if is_native(voice, language) else rng.sample(some, 2)
            words += [Clip(voice, text, word) for text, word in chosen]
        alike += [Clip(voice, text) for text in rng.sample(known.alike, 3)]
    for accents in speakers.values():
        voice = rng.choice(accents)
        for text, word in (rng.choice(some) for some in ends):
            words.append(_by_espeak(rng, language, voice, text, word))
        for text in rng.sample(known.alike, 3):
            alike.append(_by_espeak(rng, language, voice, text))
    free = _sentences(language, half)
    talk = [
        Clip(natural[number % len(natural)], free[number % len(free)])
        for number in range(SENTENCES["kokoro"])
    ]
    for number in range(SENTENCES["espeak"]):
        voice = rng.choice([one for accents in speakers.values() for one in accents])
        talk.append(_by_espeak(rng, language, voice, free[number % len(free)]))
    return Said(words, alike, talk)


def _by_espeak(rng: random.Random, language: str, voice: str, text: str, word: str = "") -> Clip:
    return Clip(voice, read_aloud(text, language), word, **espeak_manner(rng))


def _sentences(language: str, half: Half) -> list[str]:
    """What the tests' corpora say in it without a stop word, of its two halves."""
    held_out = half is Half.HELD_OUT
    return [
        one.says
        for one in read_corpus()
        if one.language == language and one.held_out is held_out and has_none(one.says, language)
    ]


def tracks_of(clips: Sequence[Clip], half: Half) -> Iterator[Track]:
    """Each clip once, some in a room and some in noise, with a pause after it."""
    rng, echoes = np.random.default_rng(47), responses(half)
    for clip in clips:
        note, track = f"{clip.voice} {clip.text}", at_speed(clip.samples, rng.uniform(0.9, 1.12))
        if rng.random() < _IN_A_ROOM:
            track = in_room(track, echoes[rng.integers(len(echoes))])
        if rng.random() < _IN_NOISE:
            kind, track = in_noise(rng, track, half)
            note = f"{kind} {note}"
        yield Track(note, clip, before_a_pause(rng, track))
