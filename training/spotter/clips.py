"""The clips to train with, by voices of the half to train with; synthesised once, then cached."""

import functools
import random
import re
from collections.abc import Iterator, Mapping
from importlib import resources
from itertools import product, zip_longest
from json import loads
from pydoc_data.topics import topics

from training.acoustics import Half
from training.acoustics.clips import Clip, espeak_manner
from training.acoustics.sentences import sentences
from training.acoustics.voices import PIPER, espeak_voices, kokoro_voices
from training.spotter import texts

_SAID = re.compile(r"stop|halt|freez|friez|\bfrees\b|\bstopp", re.IGNORECASE)
"""Words with a stop word in them, and those that sound the same as one."""
NONE = ""
READINGS, WORDS_READ = 10_000, 12_000
"""Of Python's manual and of our own sentences, and words in no order, by espeak-ng: it is quick."""
NATURAL_READINGS = 2_600
"""The same by natural voices."""
ESPEAK_ROUNDS = 4
"""So often each speaker of espeak-ng in each accent says a few stop words, each time others."""
ALIKE_EACH, ALIKE_EACH_ESPEAK = 20, 60
"""So many words that sound like a stop word are said by each voice."""
ALIKE_AROUND = ("{}.", "{}!", "A {}.", "My {}.", "That {} again.", "{} it.", "No {}?")
SPEEDS = (0.8, 0.9, 1.0, 1.1, 1.25)
"""Of Kokoro's voices, which say each text at one of them."""


@functools.cache
def _spoken() -> Mapping[str, str]:
    """English words, and their sounds in the letters of misaki's dictionary, without stress."""
    file = resources.files("misaki").joinpath("data", "us_gold.json")
    known = loads(file.read_text("utf-8"))
    plain = {word: one if isinstance(one, str) else one["DEFAULT"] for word, one in known.items()}
    return {word: re.sub("[ˈˌː]", "", one or "") for word, one in plain.items()}


def _unlike(one: str, other: str) -> int:
    """How many letters of one are others, too many or too few beside the other (Levenshtein)."""
    before = [*range(len(other) + 1)]
    for row, letter in enumerate(one, 1):
        now = [row]
        for at, wanted in enumerate(other):
            now.append(min(before[at + 1] + 1, now[at] + 1, before[at] + (letter != wanted)))
        before = now
    return before[-1]


def dictionary() -> list[str]:
    """Ordinary English words without a stop word in them."""
    return [
        word
        for word in sorted(_spoken())
        if word.isalpha() and word.islower() and 2 <= len(word) <= 9 and has_none(word)
    ]


def alike() -> list[str]:
    """Words of the dictionary with all but one or two of a stop word's sounds, the nearest twice.

    Sounds are those of American English; one more, one less or another one in its place counts.
    """
    sounds = {word: _spoken()[word] for word in dictionary()}
    found = []
    for stop in texts.WORDS:
        far = {word: _unlike(one, _spoken()[stop]) for word, one in sounds.items()}
        found += [word for word, n in far.items() for _ in range(3 - n) if n]
    return [word for word in found if len(word) > 2]


def has_none(text: str) -> bool:
    """Whether it holds no stop word, and nothing that sounds the same as one."""
    return not _SAID.search(text)


def word_of(text: str) -> str:
    """The stop word that a text holds."""
    return next((word for word in texts.WORDS if word in text.casefold()), NONE)


def kokoro_clips() -> list[Clip]:
    """As they take long, the most needed first: each voice says each stop word in many ways, then
    a little of everything else.
    """
    rng, voices = random.Random(5), list(kokoro_voices(Half.TRAIN))
    rng.shuffle(voices)
    stops = [*zip_longest(*texts.STOPS.values()), texts.STOPS_WITHIN]
    said = [text for row in stops for text in row if text]
    others = [*texts.ALIKE, *texts.COMMANDS, *texts.OWN]
    some: list[tuple[str, str]] = []
    for turn, text in enumerate(said):
        some += [(voice, text) for voice in voices]
        known = sentences(Half.TRAIN) if turn % 3 == 2 else others
        first = rng.randrange(len(known))
        some += [(v, known[(first + i) % len(known)]) for i, v in enumerate(voices[turn % 2 :: 2])]
    some += [(v, text) for v in texts.CHATTING for text in (*texts.CHAT, *texts.COMMANDS)]
    return [clip_of(voice, text, speed=rng.choice(SPEEDS)) for voice, text in dict.fromkeys(some)]


def clips_after_words() -> list[Clip]:
    """Stop words after other words: each voice says each after some, espeak-ng's also after words
    that make no sense.
    """
    rng, found, known = random.Random(29), [], dictionary()
    for voice, word in product(kokoro_voices(Half.TRAIN), texts.WORDS):
        said = [before.format(word) for before in rng.sample(texts.BEFORE, 8)]
        found += [clip_of(voice, text, speed=rng.choice(SPEEDS)) for text in said]
    for voice, word in product(espeak_voices(Half.TRAIN), texts.WORDS):
        said = [rng.choice(texts.BEFORE).format(word)]
        said += [" ".join((*rng.sample(known, rng.randint(1, 4)), word)) + "." for _ in range(3)]
        found += [clip_of(voice, text, **_by_espeak(rng)) for text in said]
    return found


def clip_of(voice: str, text: str, **options: float) -> Clip:
    """A text said by a voice, with the stop word that it holds."""
    word = word_of(text) if text not in texts.ALIKE else NONE
    return Clip(voice, text, word, bool(word) and text in texts.STOPS_WITHIN, **options)


def piper_clips() -> list[Clip]:
    """The robot's own voice: it says what the robot answers, and also stops it. That its "Stopped."
    is nothing to stop for was learnt once, and its "Stop!" was missed then.
    """
    rng, known = random.Random(9), dictionary()
    stops = [*texts.STOPS_WITHIN, *(text for some in texts.STOPS.values() for text in some)]
    others = [*texts.ALIKE, *texts.COMMANDS, *texts.OWN]
    others += [sentence(rng, known) for _ in range(60)]
    return [clip_of(PIPER, text) for text in (*stops, *others)]


def _by_espeak(rng: random.Random) -> dict[str, int]:
    return espeak_manner(rng, 125, 240)


def espeak_clips() -> list[Clip]:
    """Every speaker in every accent, at many pitches and speeds."""
    rng, known, found = random.Random(13), dictionary(), []
    others = (*texts.ALIKE, *texts.COMMANDS, *texts.OWN)
    for voice in (*espeak_voices(Half.TRAIN),) * ESPEAK_ROUNDS:
        said = [rng.choice(some) for some in texts.STOPS.values() for _ in range(2)]
        said += [rng.choice(texts.STOPS_WITHIN), rng.choice(texts.ALIKE), rng.choice(texts.ALIKE)]
        said += [rng.choice(others), *(sentence(rng, known) for _ in range(3))]
        found += [clip_of(voice, text, **_by_espeak(rng)) for text in said]
    return found


def reading_clips(number: int = READINGS) -> list[Clip]:
    """English as it is written and said: our own sentences, and those of the manual that comes with
    Python, by espeak-ng's voices.
    """
    rng, voices = random.Random(17), espeak_voices(Half.TRAIN)
    known = [*sentences(Half.TRAIN), *manual()]
    return [Clip(rng.choice(voices), rng.choice(known), **_by_espeak(rng)) for _ in range(number)]


def words_read_clips(number: int = WORDS_READ) -> list[Clip]:
    """Words in no order, by espeak-ng's voices: there is no end to what may be said."""
    rng, voices, words = random.Random(31), espeak_voices(Half.TRAIN), dictionary()
    return [
        Clip(rng.choice(voices), sentence(rng, words), **_by_espeak(rng)) for _ in range(number)
    ]


def natural_reading_clips(number: int = NATURAL_READINGS) -> list[Clip]:
    """The same by Kokoro's voices, and words in no order: what is said most must not stop a robot
    in a natural voice.
    """
    rng, voices, words = random.Random(23), list(kokoro_voices(Half.TRAIN)), dictionary()
    known = [*sentences(Half.TRAIN), *manual()]
    return [
        Clip(
            rng.choice(voices), sentence(rng, words) if turn % 2 else rng.choice(known),
            speed=rng.choice(SPEEDS),
        )
        for turn in range(number)
    ]  # fmt: skip


def alike_clips() -> Iterator[Clip]:
    """Words that sound like a stop word, by every voice."""
    rng, known = random.Random(41), alike()
    for voice in kokoro_voices(Half.TRAIN):
        for word in rng.sample(known, ALIKE_EACH):
            yield Clip(voice, _around(rng, word), speed=rng.choice(SPEEDS))
    for voice in espeak_voices(Half.TRAIN):
        for word in rng.choices(known, k=ALIKE_EACH_ESPEAK):
            yield Clip(voice, _around(rng, word), **_by_espeak(rng))


def _around(rng: random.Random, word: str) -> str:
    return rng.choice(ALIKE_AROUND).format(word).capitalize()


def manual() -> list[str]:
    """Sentences of Python's manual without a stop word: those of the Python that runs this."""
    text = " ".join("\n".join(topics.values()).split())
    plain = (re.sub(r"[^A-Za-z0-9,.;'? -]", " ", one) for one in re.split(r"(?<=[.!?:]) ", text))
    return [one for one in plain if 20 < len(one) < 130 and has_none(one)]


def sentence(rng: random.Random, known: list[str]) -> str:
    """Words in no order, as long as a sentence: all that may be said, for its sound."""
    chosen = [rng.choice(known) for _ in range(rng.randint(4, 10))]
    return " ".join([*chosen[:2], "the", *chosen[2:]]) + "."


def all_clips() -> Iterator[Clip]:
    """Those of all engines."""
    yield from espeak_clips()
    yield from reading_clips()
    yield from words_read_clips()
    yield from piper_clips()
    yield from kokoro_clips()
    yield from natural_reading_clips()
    yield from clips_after_words()
    yield from alike_clips()
