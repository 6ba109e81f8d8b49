"""How dialogues are written in YAML: `README.md` says it for people."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import yaml

from edgevox.agent.skills import Call

PARTS = {"sentences", "dialogues"}
HEADER = {"language", "robot", "rooms", "aliases", "skills", "confirm", "certain", "hears"}
"""What a file, a part of it or a dialogue may say of the robot and its conversation."""
HAPPENS = ("say", "hear", "run", "goal", "means", "wait_s", "arrive", "reset", "interrupt",
           "confirm", "speak", "learn", "lose")  # fmt: skip
"""What may happen in a line, one of these."""
COMES = {"does", "begins", "asks", "answered", "says", "refuses", "fails", "mentions", "omits",
         "writes"}  # fmt: skip
"""What may come of it."""
PLAIN = {"say", "hear", "confirm", "arrive", "reset"}
"""What leaves nothing behind that a reset would not forget."""
HOW = {"confidence", "others"}

Line = Mapping[str, Any]


@dataclass(frozen=True)
class Dialogue:
    """A title, what is said of the robot, and the lines."""

    title: str
    header: Mapping[str, Any]
    lines: tuple[Line, ...]

    @property
    def plain(self) -> bool:
        """Whether its robot is as new after a reset."""
        return all(PLAIN & line.keys() for line in self.lines)


def dialogues(text: str) -> Iterator[Dialogue]:
    """All that are in a file; `sentences` are dialogues of one line."""
    for part in yaml.safe_load_all(text):
        header = {name: part[name] for name in part if name not in PARTS}
        _known(header, HEADER)
        about = header.get("robot", "")
        for said, then in part.get("sentences", {}).items():
            line = {"say": said, **(then if isinstance(then, dict) else {"does": then})}
            yield Dialogue(f"{about}: {said}", header, (_checked(line),))
        for title, told in part.get("dialogues", {}).items():
            own = dict(told) if isinstance(told, dict) else {"lines": told}
            lines = [_checked(line) for line in own.pop("lines")]
            _known(own, HEADER)
            for which, chosen in _each(lines):
                yield Dialogue(f"{about}: {title} {which}".strip(" :"), {**header, **own}, chosen)


def files(folder: Path) -> Iterator[Path]:
    return iter(sorted(folder.glob("*.yaml")))


def calls(written: str | None) -> list[Call]:
    """What `navigate_to(room=kitchen) + get_pose()` says."""
    found = []
    for one in written.split(" + ") if written else ():
        name, _, inside = one.strip().removesuffix(")").partition("(")
        pairs = [pair.split("=", 1) for pair in inside.split(", ") if pair]
        found.append(Call(name, {key: yaml.safe_load(value) for key, value in pairs}))
    return found


def listed(one: Any) -> list[Any]:
    """One thing or a list of them, as a list."""
    return one if isinstance(one, list) else [one]


def _checked(line: Line) -> Line:
    _known(line, {*HAPPENS, *COMES, *HOW})
    if sum(name in line for name in HAPPENS) != 1:
        raise ValueError(f"{dict(line)}: exactly one of {HAPPENS} happens in a line")
    return line


def _known(written: Mapping[str, Any], known: set[str]) -> None:
    if unknown := written.keys() - known:
        raise ValueError(f"{dict(written)}: {sorted(unknown)} is none of {sorted(known)}")


def _each(lines: list[Line]) -> Iterator[tuple[str, tuple[Line, ...]]]:
    """A dialogue for each of the sentences that a line has, called after it."""
    ways = []
    for line in lines:
        (key,) = (name for name in HAPPENS if name in line)
        several = isinstance(line[key], list)
        ways.append([(said if several else "", {**line, key: said}) for said in listed(line[key])])
    for chosen in product(*ways):
        yield " / ".join(str(said) for said, _ in chosen if said), tuple(one for _, one in chosen)
