"""Tells words that were heard from words that were only expected.

Shown the robot's own commands before, Whisper understands far more of them in noise, and now and
then takes one for another: "Turn around." beside a vacuum cleaner for "Turn left.". Where it is not
sure of its words it listens again without having been shown anything. What it does not even think
of then is less sure to have been said.
"""

from collections.abc import Sequence
from dataclasses import replace

from edgevox.voice.stt.hallucinations import Segment, plain_words
from edgevox.voice.stt.speech_to_text import Transcript

LANGUAGES = frozenset({"en"})
"""In which the robot's own commands are shown. In others only how numbers are written is."""
LISTEN_AGAIN_BELOW = 0.9
"""Words that are at least so sure were heard."""
AWAY = 2.0
"""In nats: what is less likely than the likeliest by so much is not thought of."""
DOUBT = 0.88
"""How much of the confidence is left of words that are not: a motion needs a yes then."""


def is_doubtful(said: Transcript, language: str) -> bool:
    """Whether to listen again."""
    return language in LANGUAGES and bool(said.text) and said.confidence < LISTEN_AGAIN_BELOW


def doubted(said: Transcript, alone: Sequence[Segment]) -> Transcript:
    """The same words, less sure where they are not among those heard without expecting any."""
    most = max((one.whole for one in alone), default=0.0)
    heard = {plain_words(one.text) for one in alone if one.whole > most - AWAY}

    def kept(text: str) -> float:
        return 1.0 if plain_words(text) in heard else DOUBT

    others = (replace(one, confidence=one.confidence * kept(one.text)) for one in said.others)
    return replace(said, confidence=said.confidence * kept(said.text), others=tuple(others))
