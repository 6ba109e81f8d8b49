"""The trained head: what a sentence is and asks for, by the encoder's features.

It tells orders, questions and small talk apart, and gives a reading its confidence.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from edgevox.agent.nlu.encoder import Floats, packaged
from edgevox.agent.nlu.meaning import ASK_FROM, SURE_FROM


@dataclass(frozen=True, slots=True)
class KindHead:
    """A multinomial regression on the encoder's features that tells kinds of sentences apart."""

    kinds: tuple[str, ...]
    """The kinds."""
    weights: Floats
    """Weights of the encoder's features, shape (kinds, size)."""
    biases: Floats
    """Biases, shape (kinds,)."""

    def likelihoods(self, features: Floats) -> Floats:
        """The likelihood of each kind."""
        logits = self.weights @ features + self.biases
        likely = np.exp(logits - logits.max())
        return np.asarray(likely / likely.sum(), np.float32)

    def likelihood(self, kind: str, features: Floats) -> float:
        """The likelihood of one kind."""
        return float(self.likelihoods(features)[self.kinds.index(kind)])

    def likeliest(self, features: Floats, first: int = 0) -> tuple[str, float]:
        """The likeliest kind from the one at this index on, and how likely it is."""
        likely = self.likelihoods(features)
        best = first + int(likely[first:].argmax())
        return self.kinds[best], float(likely[best])


@dataclass(frozen=True, slots=True)
class Head:
    """Logistic regressions.

    One tells orders from other sentences, one judges a reading, and one tells questions about the
    world in general from those about what is here and now, the speaker and the robot. Three more
    tell kinds of small talk, what a sentence asks a robot to do, and what to tell; a last one tells
    orders for now from conditions, reports and the like.
    """

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
    general_weights: Floats
    """Weights of the encoder's features in the third regression, shape (size,)."""
    general_bias: float
    """Bias of the third regression."""
    talk: KindHead
    """Tells kinds of small talk: the keys of `training/decision/small_talk.yaml`."""
    asked: KindHead
    """Tells what a robot is asked to do: the keys of `training/decision/asked/*.yaml`."""
    told: KindHead
    """Tells what a robot is asked to tell: the keys of `training/decision/told/*.yaml`."""
    meant: KindHead
    """Tells how words about a motion are meant: the keys of `training/decision/meant/*.yaml`."""

    def order(self, features: Floats) -> float:
        """Logit of a sentence to be an order to the hearer."""
        return float(features @ self.order_weights + self.order_bias)

    def general(self, features: Floats) -> float:
        """Logit of a sentence to be answered by general knowledge."""
        return float(features @ self.general_weights + self.general_bias)

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
    with packaged() as data:
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
        general_weights=np.asarray(data["general_weights"], np.float32),
        general_bias=float(data["general_bias"]),
        talk=_kind_head(data, "talk"),
        asked=_kind_head(data, "asked"),
        told=_kind_head(data, "told"),
        meant=_kind_head(data, "meant"),
    )


def _kind_head(data: Mapping[str, Any], name: str) -> KindHead:
    return KindHead(
        tuple(map(str, data[f"{name}_kinds"])),
        np.asarray(data[f"{name}_weights"], np.float32),
        np.asarray(data[f"{name}_biases"], np.float32),
    )
