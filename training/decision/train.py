"""Train the rest of the head, `edgevox/agent/nlu/head.npz`, once `adapter.py` is done.

Three logistic regressions, by Newton's method, so that every run gives the same file. One tells
orders from everything else that is said, by the tuning half of `tests/corpus`, and by
`sentences.yaml` and `cases` that were written for it; nothing of the half that is held out. The
second one judges readings; it learns from likelihoods of the first one that never saw the sentence.
The third one learns from `questions.yaml` what a language model may answer.

    python -m training.decision.train [FILE]
"""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from corpus_robots import is_right, skills_of_robots
from corpus_sentences import ROBOTS, Sentence

from edgevox.agent.nlu.encoder import ENCODER, Encoder, Floats
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.templates import Recogniser
from edgevox.agent.stop.words import SafetyWords
from edgevox.models import locate
from training.decision.kinds import general_sentences, more_sentences, sentences, write_head

FOLDS = 10
ORDER_PENALTY, PENALTY = 30.0, 1.0
BEYOND = ("beyond", "exist", "not there", "cannot do", "no skill answers", "to others")
"""Categories of others that are orders or questions to a robot, of what it cannot do."""
ASK_LIKELIHOOD, SURE_LIKELIHOOD = 0.5, 0.93


@dataclass(frozen=True, slots=True)
class Case:
    """A reading of a sentence, and whether it is what should be done."""

    sentence: int
    evidence: Mapping[str, float]
    right: bool
    weight: float
    held_back: bool
    note: str


def cases_of(sentences: list[Sentence]) -> list[Case]:
    """The readings of what no template and no stop word catches."""
    skills = skills_of_robots()
    found: list[Case] = []
    readers: dict[tuple[str, str], Readings] = {}
    recognisers: dict[tuple[str, str], Recogniser] = {}
    for number, one in enumerate(sentences):
        for robot in ROBOTS if one.anywhere else [one.robot]:
            place = (robot, one.language)
            if place not in readers:
                readers[place] = Readings(skills[robot], one.language)
                recognisers[place] = Recogniser(skills[robot], one.language)
            if SafetyWords(one.language).find(one.says):
                continue
            if hasattr(recognisers[place].recognise(one.says), "calls"):
                continue
            if judged := readers[place].of(one.says):
                right = is_right(one, robot, judged.reading.calls)
                weight = 1 / len(ROBOTS) if one.anywhere else 1.0
                note = f"{robot[6:9]} {one.language} {one.category} | {one.says} -> " + "; ".join(
                    f"{c.skill}({', '.join(map(str, c.arguments.values()))})"
                    for c in judged.reading.calls
                )
                found.append(Case(number, judged.evidence, right, weight, judged.held_back, note))
    return found


def logistic(
    values: Floats, wanted: Floats, penalty: float, weights: Floats | None = None
) -> Floats:
    """Weights and, last, the bias of a logistic regression with a penalty on its weights."""
    data = np.c_[values, np.ones(len(values))].astype(np.float64)
    mass = np.ones(len(data)) if weights is None else weights
    ridge = np.full(data.shape[1], penalty)
    ridge[-1] = 1e-6
    found = np.zeros(data.shape[1])
    for _ in range(30):
        likelihood = 1 / (1 + np.exp(-np.clip(data @ found, -30, 30)))
        slope = data.T @ (mass * (likelihood - wanted)) + ridge * found
        curve = (data * (mass * likelihood * (1 - likelihood))[:, None]).T @ data + np.diag(ridge)
        step = np.linalg.solve(curve, slope)
        found = found - step
        if np.abs(step).max() < 1e-8:
            break
    return found


def scores(values: Floats, found: Floats) -> Floats:
    """The logits of these."""
    return values @ found[:-1] + found[-1]


def train(encoder: Encoder, show: bool = False) -> dict[str, object]:
    """The arrays of the regressions that tell orders and judge readings.

    The encoder's adapter has learnt from most of these sentences: what `show` prints is optimistic.
    """
    several, more = sentences(), more_sentences()
    texts = [one.says for one in several] + [says for says, _ in more]
    orders = np.array([one.is_command for one in several] + [order for _, order in more], float)
    beyond = np.array(
        [not s.is_command and any(b in s.category for b in BEYOND) for s in several]
        + [False] * len(more)
    )
    raw = np.array([encoder.features(text) for text in texts], np.float64)
    mean, spread = raw.mean(0), raw.std(0) + 1e-6
    features = (raw - mean) / spread
    fold = np.array([hash_of(text) % FOLDS for text in texts])
    unseen = np.zeros(len(texts))
    for number in range(FOLDS):
        kept = (fold != number) & ~beyond
        unseen[fold == number] = scores(
            features[fold == number], logistic(features[kept], orders[kept], ORDER_PENALTY)
        )
    whole = logistic(features[~beyond], orders[~beyond], ORDER_PENALTY)
    cases = cases_of(several)
    names = list(cases[0].evidence)
    values = np.array(
        [[*(float(one.evidence[n]) for n in names), unseen[one.sentence]] for one in cases]
    )
    right = np.array([one.right for one in cases], float)
    weight = np.array([one.weight for one in cases])
    middle, width = values.mean(0), values.std(0) + 1e-6
    scaled = (values - middle) / width
    where = fold[[one.sentence for one in cases]]
    likely = np.zeros(len(cases))
    for number in range(FOLDS):
        kept = where != number
        found = logistic(scaled[kept], right[kept], PENALTY, weight[kept])
        likely[~kept] = 1 / (1 + np.exp(-scores(scaled[~kept], found)))
    found = logistic(scaled, right, PENALTY, weight)
    if show:
        report(cases, likely, right)
    return {
        "order_weights": (whole[:-1] / spread).astype(np.float32),
        "order_bias": np.float64(whole[-1] - (whole[:-1] * mean / spread).sum()),
        "names": np.array(names),
        "weights": (found[:-1] / width).astype(np.float32),
        "bias": np.float64(found[-1] - (found[:-1] * middle / width).sum()),
        "ask": np.float64(ASK_LIKELIHOOD),
        "sure": np.float64(SURE_LIKELIHOOD),
    }


def train_general(encoder: Encoder) -> dict[str, object]:
    """The arrays of the regression that tells questions about the world in general."""
    rows = general_sentences()
    raw = np.array([encoder.features(says) for says, _ in rows], np.float64)
    mean, spread = raw.mean(0), raw.std(0) + 1e-6
    wanted = np.array([general for _, general in rows], float)
    share = wanted.mean()  # of both there is as much then, however many there are
    weights = np.where(wanted > 0, 0.5 / share, 0.5 / (1 - share))
    found = logistic((raw - mean) / spread, wanted, ORDER_PENALTY, weights)
    return {
        "general_weights": (found[:-1] / spread).astype(np.float32),
        "general_bias": np.float64(found[-1] - (found[:-1] * mean / spread).sum()),
    }


def report(cases: list[Case], likely: Floats, right: Floats) -> None:
    """What the head says of sentences that it was not trained with, as far as it may decide."""
    free = np.array([not one.held_back for one in cases])
    for level in (0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95):
        above = free & (likely >= level)
        print(
            f"{level:.2f}: {int(right[above].sum())} right of {int(right.sum())},"
            f" {int((1 - right[above]).sum())} wrong of {int((1 - right).sum())}"
        )
    order = np.argsort(-likely)
    for wanted, title, chosen in ((0.0, "wrong", order), (1.0, "missed", order[::-1])):
        print(title)
        shown = [i for i in chosen if right[i] == wanted and (free[i] or wanted)][:60]
        for i in shown:
            print(f"  {likely[i]:.2f}{'' if free[i] else ' held back'} {cases[i].note}")


def hash_of(text: str) -> int:
    """The same number in every run."""
    return int.from_bytes(text.encode()[-6:], "big") % 9973


def main() -> int:
    """Train, say how well it tells what it was not trained with, and write the file."""
    encoder = Encoder(locate(ENCODER))
    arrays = train(encoder, show=True) | train_general(encoder)
    write_head(arrays, *map(Path, sys.argv[1:]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
