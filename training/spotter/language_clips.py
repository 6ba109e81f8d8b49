"""What voices of the half to train with say in another language: stop words and everything else."""

import random
import re
from collections.abc import Iterator, Mapping, Sequence
from unicodedata import category

from edgevox.core.languages import language_file
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
from training.spotter.clips import SPEEDS

OF_A_VOICE = {"ends": 6, "within": 1, "alike": 1, "talk": 1}
"""So many of the texts each voice of Kokoro's says that has an accent; a native one says all."""
READINGS, READ_WORDS = 1_500, {"ja": 2, "zh": 2}
"""Of words of the language in any order, by espeak-ng: six at once, fewer where they are whole
phrases, as nothing is between words.
"""


def language_clips(language: str) -> list[Clip]:
    """All of them, the stop words first."""
    rng = random.Random(f"clips of {language}")
    return [*_by_kokoro(rng, language), *_by_espeak(rng, language)]


def vocabulary(language: str) -> list[str]:
    """Words of the language, as the robot's own file has them, without its stop words."""
    words = {word for text in _strings(language_file(language)) for word in _words_of(text)}
    return sorted(word for word in words if has_none(word, language))


def _words_of(text: str) -> Iterator[str]:
    for piece in text.split():
        word = piece.strip("".join(one for one in piece if category(one)[0] in "PS"))
        if word and not any(category(one)[0] in "NPS" and one not in "-'" for one in word):
            yield word


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield re.sub(r"[{<][^}>]*[}>]", " ", value)
    elif isinstance(value, Mapping):
        for name, one in value.items():
            if name != "stop":
                yield from _strings(one)
    elif isinstance(value, Sequence):
        for one in value:
            yield from _strings(one)


def _said(language: str) -> dict[str, list[tuple[str, str, bool]]]:
    """Text, the stop word in it and whether it goes on after that, by kind."""
    known = texts(language, Half.TRAIN)
    return {
        "ends": [(text, word, False) for word, some in known.ends.items() for text in some],
        "within": [(text, word, True) for word, some in known.within.items() for text in some],
        "alike": [(text, "", False) for text in known.alike],
        "talk": [(text, "", False) for text in known.talk],
    }


def _by_kokoro(rng: random.Random, language: str) -> Iterator[Clip]:
    said = _said(language)
    for voice in kokoro_speakers(language, Half.TRAIN):
        for kind, some in said.items():
            chosen = some if is_native(voice, language) else rng.sample(some, OF_A_VOICE[kind])
            for text, word, within in chosen:
                yield Clip(voice, text, word, within, speed=rng.choice(SPEEDS))


def _by_espeak(rng: random.Random, language: str) -> Iterator[Clip]:
    said, known = _said(language), vocabulary(language)
    voices = espeak_speakers_of(language, Half.TRAIN)
    for voice in voices:
        for kind, of_them in (("ends", 0.6), ("within", 0.6), ("alike", 0.5), ("talk", 0.2)):
            for text, word, within in _share(rng, said[kind], of_them):
                yield _espeak_clip(rng, voice, read_aloud(text, language), word, within)
    for number in range(READINGS):
        text = read_aloud(_reading(rng, known, language), language)
        yield _espeak_clip(rng, voices[number % len(voices)], text)


def _share(
    rng: random.Random, some: Sequence[tuple[str, str, bool]], share: float
) -> list[tuple[str, str, bool]]:
    return rng.sample(some, max(1, round(share * len(some))))


def _reading(rng: random.Random, known: Sequence[str], language: str) -> str:
    """Some words, in an order in which they are no stop word either."""
    many = READ_WORDS.get(language, 6)
    while not has_none(text := " ".join(rng.sample(known, many)), language):
        pass
    return text


def _espeak_clip(
    rng: random.Random, voice: str, text: str, word: str = "", within: bool = False
) -> Clip:
    return Clip(voice, text, word, within, **espeak_manner(rng, 125, 230))
