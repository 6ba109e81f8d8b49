"""The sentences of each kind that the encoder learns to tell apart, by the name of the regression.

`asked`: what a robot is asked to do, from `asked`. `told`: what it is asked to tell, from `told`.
`meant`: whether words about a motion want it now, from `meant`. `talk`: kinds of small talk, from
`small_talk.yaml`. Beside them the sentences that `train.py` learns from, and the file of it all.
"""

import hashlib
import random
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import yaml
from corpus_sentences import Sentence, read_corpus, tuning

from edgevox.agent.nlu.decider import NOW
from edgevox.agent.nlu.encoder import HEAD_FILE

FOLDER = Path(__file__).parent
HEAD = FOLDER.parents[1] / "edgevox" / "agent" / "nlu" / HEAD_FILE
CASES = FOLDER / "cases"
NO_TALK = "none"
"""Sentences that are no small talk, or ask to tell nothing that a skill does."""
NO_KIND = ""
"""Kind of all sentences that are no small talk."""
FIRST = {"asked": "talk", "told": NO_TALK, "meant": NOW, "talk": NO_KIND}
"""The kind that comes first, by regression: of what is plainest."""
TALKS = ("small talk", "praise", "insults", "jokes", "feelings", "complaints", "permission",
         "religion", "questions about the robot", "weather")  # fmt: skip
"""Categories of the corpus that may hold small talk, and are no counter-example of it."""
MOST_OTHERS = 6000
"""Number of sentences that are no small talk that it is told from."""


def lists_of(name: str) -> dict[str, list[str]]:
    """The lists of sentences in a file of this folder."""
    read: dict[str, list[str]] = yaml.safe_load((FOLDER / name).read_text(encoding="utf-8"))
    return read


def more_sentences() -> list[tuple[str, bool]]:
    """Sentences to and near machines of other kinds, and whether they are orders."""
    data = lists_of("sentences.yaml")
    return [(says, kind == "orders") for kind, several in data.items() for says in several]


def general_sentences() -> list[tuple[str, bool]]:
    """Questions and small talk, and whether general knowledge answers them."""
    rows = [
        (says, kind == "general")
        for kind, some in lists_of("questions.yaml").items()
        for says in some
    ]
    talk = lists_of("small_talk.yaml")
    return rows + [(says, False) for kind, some in talk.items() if kind != NO_TALK for says in some]


def sentences() -> list[Sentence]:
    """What of the corpus may be learnt from."""
    return [*tuning(), *read_corpus(CASES)]


def by_kind(name: str) -> list[tuple[str, str]]:
    """Each sentence of the files `LANGUAGE.yaml` of a folder, with its kind."""
    files = sorted((FOLDER / name).glob("*.yaml"))
    return [
        (says, kind)
        for file in files
        for kind, some in lists_of(f"{name}/{file.name}").items()
        for says in some
    ]


def all_kinds() -> dict[str, list[tuple[str, str]]]:
    """The sentences with their kinds, by regression."""
    orders = [(one.says, NOW) for one in sentences() if one.is_command]
    talk = lists_of("small_talk.yaml")
    other = [*talk.pop(NO_TALK), *_no_small_talk()]
    if len(other) > MOST_OTHERS:
        other = random.Random(1).sample(other, MOST_OTHERS)
    return {
        "asked": by_kind("asked"),
        "told": by_kind("told"),
        "meant": [*by_kind("meant"), *orders],
        "talk": [
            *((says, NO_KIND) for says in other),
            *((says, kind) for kind, some in talk.items() for says in some),
        ],
    }


def is_apart(says: str) -> bool:
    """True for every tenth sentence, the same ones in every run."""
    return hashlib.sha256(says.encode()).digest()[0] % 10 == 0


def write_head(arrays: Mapping[str, object], place: Path = HEAD) -> None:
    """Write the head's file with these arrays, and with what it has beside them."""
    with np.load(HEAD) as data:
        kept = {name: one for name, one in data.items() if name not in arrays}
    with place.open("wb") as file:
        np.savez(file, **kept, **arrays)  # type: ignore[arg-type]
    print(f"{place}: {place.stat().st_size} bytes")


def _no_small_talk() -> Iterator[str]:
    questions = lists_of("questions.yaml")
    yield from [*questions["general"], *questions["state"]]
    yield from (one.says for one in tuning() if not one.category.startswith(TALKS))
    yield from (says for says, _ in more_sentences())
    for name in ("asked", "told"):
        yield from (says for says, kind in by_kind(name) if kind != FIRST[name])
