"""The sentences of `tests/corpus`: what people say to robots and near them, and what should follow.

A hash of the sentence, however it is spelled, parts them into a half to tune with and a half that
is held out: nobody looks at that one, no product is made of it, and reports count it apart. What is
said near any robot is said near one of them, by the same hash.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from edgevox.agent.skills import Call
from edgevox.agent.text.spelling import key

FOLDER = Path(__file__).parent / "corpus"
ROBOTS = ("robot-apartment", "robot-external", "robot-humanoid", "robot-panda")
ANY = "any"

Calls = tuple[Call, ...]


@dataclass(frozen=True, slots=True)
class Sentence:
    """What somebody says to or near a robot; `outcomes` are the calls of which any is right."""

    says: str
    robot: str
    language: str
    category: str
    outcomes: tuple[Calls, ...]
    anywhere: bool = False

    @property
    def is_command(self) -> bool:
        """Whether something should be done, at best."""
        return bool(self.outcomes[0])

    @property
    def held_out(self) -> bool:
        """Whether it belongs to the half that nothing is made of."""
        return is_held_out(self.says)


def is_held_out(says: str) -> bool:
    """Whether a sentence of these words belongs to the half that nothing is made of."""
    return bool(_digest(says) & 1)


def read_corpus(folder: Path = FOLDER) -> list[Sentence]:
    """All of it, in the order of the files."""
    return list(_read_folder(folder))


def tuning(sentences: Iterable[Sentence] | None = None) -> list[Sentence]:
    """The half that may be looked at."""
    given = read_corpus() if sentences is None else sentences
    return [one for one in given if not one.held_out]


def held_out(sentences: Iterable[Sentence] | None = None) -> list[Sentence]:
    """The half that is only counted."""
    given = read_corpus() if sentences is None else sentences
    return [one for one in given if one.held_out]


@lru_cache
def _read_folder(folder: Path) -> tuple[Sentence, ...]:
    return tuple(one for file in sorted(folder.glob("*.yaml")) for one in _read_file(file))


def _read_file(file: Path) -> Iterator[Sentence]:
    for data in yaml.load_all(file.read_text(encoding="utf-8"), yaml.CSafeLoader):
        for kind in ("commands", "others"):
            for category, several in (data.get(kind) or {}).items():
                for one in several:
                    yield _sentence(one, category, data["robot"], data["language"])


def _sentence(data: Any, category: str, robot: str, language: str) -> Sentence:
    given = {"says": data} if isinstance(data, str) else data
    outcomes = (given.get("calls", []), *given.get("or", []))
    anywhere = given.get("robot", robot) == ANY
    return Sentence(
        given["says"],
        ROBOTS[(_digest(given["says"]) >> 1) % len(ROBOTS)] if anywhere else robot,
        language,
        category,
        tuple(map(_calls, outcomes)),
        anywhere,
    )


def _calls(data: Iterable[Mapping[str, Mapping[str, Any]]]) -> Calls:
    return tuple(Call(name, dict(given or {})) for one in data for name, given in one.items())


def _digest(says: str) -> int:
    return int.from_bytes(hashlib.sha256(key(says).encode()).digest()[:8])
