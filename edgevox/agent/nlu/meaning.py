"""What an utterance means: the calls, or the program, and how sure that is.

Says how sure it is that a reading of a sentence is what the speaker wants done, now.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from io import BytesIO
from typing import Any

import numpy as np

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.encoder.packed_file import Floats
from edgevox.agent.nlu.orders import Program, calls_of
from edgevox.agent.skills import Call

HEAD_FILE = "head.npz"
"""Made by `training/decision/train.py`."""

ASK_FROM, SURE_FROM = 0.5, 0.8
"""Below the first nothing is done, from the second on it is done unasked; between, one asks."""

HEARD_FROM = 0.8
"""A motion whose words are less sure to have been said is asked about; and so is one that was read
into words that no template knows, where both together are less sure, multiplied. Of 1,152 commands
by voices to tune with (`training/acoustics`), in noise at 10, 5 and 0 dB, none wrong was done,
with words that were only expected held for less sure (`edgevox.voice.stt.plausible`); with 0.75
one was."""


@dataclass(frozen=True, slots=True)
class Head:
    """Two logistic regressions.

    One is over what the encoder makes of a sentence, and tells an order from anything else that is
    said; the other over that and the evidence of a reading.

    `ask` and `sure` are the likelihoods from which to ask and to act.
    """

    order_weights: Floats
    order_bias: float
    names: tuple[str, ...]
    weights: Floats
    bias: float
    ask: float
    sure: float

    def order(self, features: Floats) -> float:
        """The logit of a sentence being an order to whoever hears it."""
        return float(features @ self.order_weights + self.order_bias)

    def likelihood(self, order: float, evidence: Mapping[str, float]) -> float:
        """Of a reading being meant."""
        values = np.array([*(float(evidence[name]) for name in self.names), order])
        return float(1 / (1 + np.exp(-(values @ self.weights + self.bias))))

    def confidence(self, likelihood: float) -> float:
        """The same on the scale on which 0.5 asks and `SURE_FROM` acts, rising with it."""
        known = (0.0, self.ask, self.sure, 1.0)
        return float(np.interp(likelihood, known, (0.0, ASK_FROM, SURE_FROM, 1.0)))


def read_head() -> Head:
    """The one that this package brings."""
    with np.load(BytesIO(files(__package__).joinpath(HEAD_FILE).read_bytes())) as data:
        return head_of(data)


def head_of(data: Mapping[str, Any]) -> Head:
    """A head from the arrays of its file."""
    return Head(
        order_weights=np.asarray(data["order_weights"], np.float32),
        order_bias=float(data["order_bias"]),
        names=tuple(str(name) for name in data["names"]),
        weights=np.asarray(data["weights"], np.float32),
        bias=float(data["bias"]),
        ask=float(data["ask"]),
        sure=float(data["sure"]),
    )


@dataclass(frozen=True, slots=True)
class Meaning:
    """What to do about an utterance, and who found it out: ``template``, ``reading`` or ``model``.

    `confidence` is that it is meant: 1 for a template; from `SURE_FROM` on it is to be done, below
    that somebody is to be asked. What is to be done later or more than once is a `program`, and
    has no `calls` to do at once.
    """

    agent: Agent
    calls: tuple[Call, ...]
    source: str
    confidence: float = 1.0
    program: Program | None = None

    @property
    def sure(self) -> bool:
        """Whether to do it without asking."""
        return self.confidence >= SURE_FROM

    @property
    def measured(self) -> float | None:
        """How sure it is, where something measured that: nobody knows how sure a model is."""
        return None if self.source == "model" else self.confidence

    def heard(self, confidence: float) -> "Meaning":
        """The same of words that are so sure to have been said: asked about if both are not."""
        if self.confidence * confidence >= HEARD_FROM:
            return self
        return replace(self, confidence=min(self.confidence, ASK_FROM))

    @property
    def every_call(self) -> tuple[Call, ...]:
        """All that may be called, those inside the program too."""
        return calls_of(self.program) if self.program else self.calls
