"""Every command that a page shows, and how each is known to work: `commands.toml`."""

import re
import shlex
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "helm/edgevox/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "training").rglob("README.md")),
]
FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_PROGRAMS = (
    r"make|docker|ros2|helm|kubectl|python3?|pip|pytest|printf|sudo|curl|colcon|source|pactl|rsync|mcap"
    r"|llama-server|espeak-ng|\.ci/run|(?:\.venv/bin/)?edgevox[\w-]*"
)
_INLINE = re.compile(rf"`((?:[A-Z_]+=\S+ )*(?:{_PROGRAMS}) [^`]+)`")
_ASSIGNMENT = re.compile(r"[A-Za-z_]+=")


@dataclass(frozen=True)
class Proof:
    """How commands are known to work: exactly one of these, and what they look like."""

    commands: tuple[str, ...]
    run: bool = False
    dry: bool = False
    test: str = ""
    needs: str = ""

    def covers(self, command: str) -> bool:
        """Whether one of the patterns is this command; `*` is anything."""
        return any(_matches(pattern, command) for pattern in self.commands)


def _matches(pattern: str, command: str) -> bool:
    return bool(re.fullmatch(re.escape(pattern).replace(r"\*", ".*"), command))


def proofs() -> list[Proof]:
    """The table."""
    table = tomllib.loads((Path(__file__).parent / "commands.toml").read_text())
    return [Proof(**one | {"commands": tuple(one["commands"])}) for one in table["proof"]]


def fences(page: Path) -> list[tuple[str, str]]:
    """Language and text of every block of a page."""
    return FENCE.findall(page.read_text(encoding="utf-8"))


def commands(page: Path) -> list[str]:
    """What a reader may type: in blocks, and in the text where it begins with a program's name."""
    found = []
    for language, text in fences(page):
        if language in ("bash", "sh"):
            found += _lines(text)
        elif language == "console":
            found += [line[2:] for line in text.splitlines() if line.startswith("$ ")]
    prose = FENCE.sub("", page.read_text(encoding="utf-8"))
    return found + [" ".join(one.replace("\\|", "|").split()) for one in _INLINE.findall(prose)]


def _lines(text: str) -> list[str]:
    joined = re.sub(r"\s*\\\n\s*|(?<=\|)\n\s*", " ", text)
    bare = (re.sub(r"(^|\s)#\s.*", "", line).strip() for line in joined.splitlines())
    return [line for line in bare if line]


def programs(command: str) -> list[list[str]]:
    """The programs of a command line with their arguments, without variables and redirections."""
    lexer = shlex.shlex(command, posix=True, punctuation_chars="|&;<>")
    lexer.whitespace_split = True
    parts: list[list[str]] = [[]]
    skip = False
    for word in lexer:
        if set(word) <= set("|&;"):
            parts.append([])
        elif set(word) <= set("<>"):
            skip = True
        elif skip:
            skip = False
        elif parts[-1] or not _ASSIGNMENT.match(word):
            parts[-1].append(word)
    return [part for part in parts if part]
