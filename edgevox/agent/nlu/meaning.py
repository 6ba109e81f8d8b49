"""The meaning of an utterance, and the trained head that gives a reading its confidence."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from io import BytesIO
from typing import Any

import numpy as np

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.encoder import Floats
from edgevox.agent.nlu.orders import Program, calls_of
from edgevox.agent.skills import Call

HEAD_FILE = "head.npz"
"""Name of the head's file, made by `training/decision/train.py`."""

ASK_FROM, SURE_FROM = 0.5, 0.8
"""Confidences from which on the robot asks, and acts without asking; below both it does nothing."""

HEARD_FROM = 0.8
"""Product of the confidences of hearing and of meaning below which the robot asks before a motion.
Of 1,152 commands by the tuning voices (`training/acoustics`), in noise at 10, 5 and 0 dB, no wrong
one was done, with a lower confidence for words that were only expected
(`edgevox.voice.stt.speech_to_text`); with 0.75 one was."""


@dataclass(frozen=True, slots=True)
class Head:
    """Two logistic regressions: one tells orders from other sentences, one judges a reading."""

    order_weights: Floats
    """Weights of the encoder's features, shape (size,)."""
    order_bias: float
    """Bias of the first regression."""
    names: tuple[str, ...]
    """Names of the evidence, in the order of `weights`."""
    weights: Floats
    """Weights of the evidence, and last that of the first regression's logit."""
    bias: float
    """Bias of the second regression."""
    ask: float
    """Likelihood from which on to ask."""
    sure: float
    """Likelihood from which on to act."""

    def order(self, features: Floats) -> float:
        """Logit of a sentence to be an order to the hearer."""
        return float(features @ self.order_weights + self.order_bias)

    def likelihood(self, order: float, evidence: Mapping[str, float]) -> float:
        """Likelihood of a reading to be meant, from 0 to 1."""
        values = np.array([*(float(evidence[name]) for name in self.names), order])
        return float(1 / (1 + np.exp(-(values @ self.weights + self.bias))))

    def confidence(self, likelihood: float) -> float:
        """The likelihood on the scale on which `ASK_FROM` asks and `SURE_FROM` acts."""
        known = (0.0, self.ask, self.sure, 1.0)
        return float(np.interp(likelihood, known, (0.0, ASK_FROM, SURE_FROM, 1.0)))


def read_head() -> Head:
    """The head that this package brings."""
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
    """The meaning of an utterance: calls to do at once, or a program."""

    agent: Agent
    """The agent whose skills are called."""
    calls: tuple[Call, ...]
    """Calls to do at once; empty for a program."""
    source: str
    """The stage that found the meaning: ``template``, ``reading`` or ``model``."""
    confidence: float = 1.0
    """Confidence in the meaning, 1 for a template; below `SURE_FROM` the robot asks."""
    program: Program | None = None
    """An order for later, or for more than once."""

    @property
    def sure(self) -> bool:
        """True if it may be done without asking."""
        return self.confidence >= SURE_FROM

    @property
    def measured(self) -> float | None:
        """The confidence; None for a language model, which measures none."""
        return None if self.source == "model" else self.confidence

    def heard(self, confidence: float) -> "Meaning":
        """The meaning of words with this recognition confidence; unsure if the product is low."""
        unsure_anyway = confidence >= HEARD_FROM and not self.sure
        if self.confidence * confidence >= HEARD_FROM or unsure_anyway:
            return self
        return replace(self, confidence=min(self.confidence, ASK_FROM))

    @property
    def every_call(self) -> tuple[Call, ...]:
        """All calls, those inside the program included."""
        return calls_of(self.program) if self.program else self.calls
