"""Tells words that were heard from words that were only expected.

Shown the robot's own commands before, Whisper understands far more of them in noise, and now and
then takes one for another: "Turn around." beside a vacuum cleaner for "Turn left.". Where it is not
sure of its words it listens again without having been shown anything. What it hears then, too, is
surer to have been said, and what it does not even think of less sure.
"""

import math
from collections.abc import Callable, Sequence

from edgevox.voice.stt.hallucinations import Segment, plain_words
from edgevox.voice.stt.speech_to_text import Transcript

SHOWN_COMMANDS = frozenset({"en"})
"""Languages in which the robot's own commands are shown (`HearingPrompts` of the agent). In others
only how numbers are written is."""
LISTEN_AGAIN_BELOW = 0.9
"""Words that are at least so sure were heard."""
NEAR, AWAY = 1.0, 2.0
"""In nats: what is so much less likely than the likeliest was heard then too, or is not thought
of."""
DOUBT = 0.88
"""How much of the confidence is left of words that are not: a motion needs a yes then."""


def is_doubtful(said: Transcript, language: str) -> bool:
    """Whether to listen again."""
    return language in SHOWN_COMMANDS and bool(said.text) and said.confidence < LISTEN_AGAIN_BELOW


def heard_again(alone: Sequence[Segment]) -> Callable[[Segment], float]:
    """How likely each of the hypotheses is, from 0 to 1, after these without expecting any: more
    where it is one of them, too, and less where it is not even thought of.
    """
    most = max((one.whole for one in alone), default=0.0)
    below: dict[str, float] = {}
    for one in alone:
        below.setdefault(plain_words(one.text), most - one.whole)

    def likelihood(one: Segment) -> float:
        away = below.get(plain_words(one.text), AWAY)
        if away <= NEAR:
            return math.sqrt(one.likelihood)
        return one.likelihood if away < AWAY else one.likelihood * DOUBT

    return likelihood
