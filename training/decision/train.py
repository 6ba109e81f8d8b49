"""Train the head that tells orders from everything else that is said: `edgevox/agent/nlu/head.npz`.

Reads the tuning half of `tests/corpus`, and `sentences.yaml` and `cases` beside it that were
written for it; nothing of the half that is held out. Three
logistic regressions, by Newton's method, so that every run gives the same file. The second one
learns from likelihoods of the first one that never saw the sentence. The third one learns from
`questions.yaml` what a language model may answer. A multinomial regression learns the kinds of
small talk from `small_talk.yaml`; others learn what a robot is asked to do from `asked`, what it is
asked to tell from `told`, and from `meant` whether words about a motion want it now.

    python -m training.decision.train [FILE]
    python -m training.decision.train --talk     # only the last ones, in the file as it is
"""

import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from scipy.optimize import minimize

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from corpus_robots import is_right, skills_of_robots
from corpus_sentences import ROBOTS, Sentence, read_corpus, tuning

from edgevox.agent.nlu.decider import NOW
from edgevox.agent.nlu.encoder import ENCODER, HEAD_FILE, Encoder, Floats
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.templates import Recogniser
from edgevox.agent.stop.words import SafetyWords
from edgevox.models import locate

HEAD = ROOT / "edgevox" / "agent" / "nlu" / HEAD_FILE
MORE = Path(__file__).with_name("sentences.yaml")
QUESTIONS = Path(__file__).with_name("questions.yaml")
SMALL_TALK = Path(__file__).with_name("small_talk.yaml")
ASKED, TOLD, MEANT = (Path(__file__).with_name(one) for one in ("asked", "told", "meant"))
NO_TALK = "none"
"""Sentences that are no small talk, or ask to tell nothing that a skill does."""
TALK_WEIGHT = 3.0
"""How much more a sentence of small talk counts than another one, of which there are more."""
TALKS = ("small talk", "praise", "insults", "jokes", "feelings", "complaints", "permission",
         "religion", "questions about the robot", "weather")  # fmt: skip
"""Categories of the corpus that may hold small talk, and are no counter-example of it."""
CASES = Path(__file__).with_name("cases")
FOLDS = 10
ORDER_PENALTY, PENALTY = 30.0, 1.0
BEYOND = ("beyond", "exist", "not there", "cannot do", "no skill answers", "to others")
"""Categories of others that are orders or questions to a robot, of what it cannot do."""
ASK_LIKELIHOOD, SURE_LIKELIHOOD = 0.5, 0.9


@dataclass(frozen=True, slots=True)
class Case:
    """A reading of a sentence, and whether it is what should be done."""

    sentence: int
    evidence: Mapping[str, float]
    right: bool
    weight: float
    held_back: bool
    note: str


def more_sentences() -> list[tuple[str, bool]]:
    """Sentences to and near machines of other kinds, and whether they are orders."""
    data = yaml.safe_load(MORE.read_text(encoding="utf-8"))
    return [(says, kind == "orders") for kind, several in data.items() for says in several]


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
    """The arrays of the head's file."""
    sentences = [*tuning(), *read_corpus(CASES)]
    more = more_sentences()
    texts = [one.says for one in sentences] + [says for says, _ in more]
    orders = np.array([one.is_command for one in sentences] + [order for _, order in more], float)
    beyond = np.array(
        [not s.is_command and any(b in s.category for b in BEYOND) for s in sentences]
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
    cases = cases_of(sentences)
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
    data = yaml.safe_load(QUESTIONS.read_text(encoding="utf-8"))
    rows = [(says, kind == "general") for kind, several in data.items() for says in several]
    talk = yaml.safe_load(SMALL_TALK.read_text(encoding="utf-8"))
    rows += [(says, False) for kind, some in talk.items() if kind != NO_TALK for says in some]
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


def train_small_talk(encoder: Encoder) -> dict[str, object]:
    """The arrays of the regression that tells kinds of small talk, and them from all else."""
    kinds = yaml.safe_load(SMALL_TALK.read_text(encoding="utf-8"))
    questions = yaml.safe_load(QUESTIONS.read_text(encoding="utf-8"))
    others = [*questions["general"], *questions["state"]]
    others += [one.says for one in tuning() if not one.category.startswith(TALKS)]
    others += [*(says for says, _ in more_sentences()), *kinds.pop(NO_TALK)]
    for folder, first in ((ASKED, "talk"), (TOLD, NO_TALK)):
        others += [says for says, kind in by_kind(folder) if kind != first]
    rows = [(says, kind) for kind, several in kinds.items() for says in several]
    rows += [(says, "") for says in others]
    return told_apart(encoder, rows, ["", *kinds], "talk", TALK_WEIGHT)


def train_kinds(
    encoder: Encoder, folder: Path, first: str, more: Iterable[str] = ()
) -> dict[str, object]:
    """The arrays of the regression that tells the kinds of sentences of all languages of a folder.

    Its file `LANGUAGE.yaml` has sentences by kind. The kind `first` comes first and has `more`.
    """
    rows = [*by_kind(folder), *((says, first) for says in more)]
    kinds = list(dict.fromkeys([first, *(kind for _, kind in rows)]))
    return told_apart(encoder, rows, kinds, folder.name)


def by_kind(folder: Path) -> list[tuple[str, str]]:
    """Each sentence of the files of a folder, with its kind."""
    return [
        (says, kind)
        for file in sorted(folder.glob("*.yaml"))
        for kind, several in yaml.safe_load(file.read_text(encoding="utf-8")).items()
        for says in several
    ]


def told_apart(
    encoder: Encoder,
    rows: list[tuple[str, str]],
    kinds: list[str],
    name: str,
    heavier: float = 1.0,
) -> dict[str, object]:
    """The arrays of a multinomial regression, named so, that tells the kinds of sentences.

    All kinds but the first are `heavier`.
    """
    raw = np.array([encoder.features(says) for says, _ in rows], np.float64)
    mean, spread = raw.mean(0), raw.std(0) + 1e-6
    wanted = np.array([[one == kind for kind in kinds] for _, one in rows], float)
    weights, biases = multinomial((raw - mean) / spread, wanted, heavier)
    return {
        f"{name}_kinds": np.array(kinds),
        f"{name}_weights": (weights / spread).astype(np.float32),
        f"{name}_biases": biases - (weights * mean / spread).sum(axis=1),
    }


def multinomial(values: Floats, wanted: Floats, heavier: float = 1.0) -> tuple[Floats, Floats]:
    """Weights and biases of a multinomial regression; all classes but the first are `heavier`."""
    size, count = values.shape[1], wanted.shape[1]
    mass = np.where(wanted[:, 0] > 0, 1.0, heavier)

    def loss(found: Floats) -> tuple[float, Floats]:
        weights, biases = found[: count * size].reshape(count, size), found[count * size :]
        logits = values @ weights.T + biases
        likely = np.exp(logits - logits.max(axis=1, keepdims=True))
        likely /= likely.sum(axis=1, keepdims=True)
        missed = -float(mass @ np.log((likely * wanted).sum(axis=1) + 1e-12))
        slope = (likely - wanted) * mass[:, None]
        slopes = np.r_[(slope.T @ values + ORDER_PENALTY * weights).ravel(), slope.sum(axis=0)]
        return missed + ORDER_PENALTY / 2 * float((weights**2).sum()), slopes

    found = minimize(
        loss, np.zeros(count * (size + 1)), jac=True, method="L-BFGS-B", options={"maxiter": 150}
    ).x
    return found[: count * size].reshape(count, size), found[count * size :]


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
    talk = sys.argv[1:] == ["--talk"]
    place = Path(sys.argv[1]) if len(sys.argv) > 1 and not talk else HEAD
    encoder = Encoder(locate(ENCODER))
    arrays = dict(np.load(HEAD)) if talk else train(encoder, show=True)
    arrays |= train_general(encoder) | train_small_talk(encoder)
    arrays |= train_kinds(encoder, ASKED, "talk") | train_kinds(encoder, TOLD, NO_TALK)
    orders = [one.says for one in [*tuning(), *read_corpus(CASES)] if one.is_command]
    arrays |= train_kinds(encoder, MEANT, NOW, orders)
    with place.open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
    print(f"{place}: {place.stat().st_size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
