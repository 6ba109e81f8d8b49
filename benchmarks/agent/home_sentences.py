"""What people say to a house, in sixteen languages: none of it asks a robot to go anywhere.

`EDGEVOX_HOME_SENTENCES` names the folder `tests` of Home Assistant's intents (OHF-Voice/intents, CC
BY 4.0). Each sentence is heard without a doubt, without a language model, by `robot-apartment` in
that language. None may move it or change anything for good, and hardly any may be asked about.
"""

import os
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import yaml

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.heard_robot import Robot
from edgevox.core.languages import LANGUAGES
from edgevox.models import ModelMissing
from edgevox.voice.stt.speech_to_text import Transcript

FOLDER = "EDGEVOX_HOME_SENTENCES"
TABLE = "What people say to a house"
THEIRS = {"pt": ("pt", "pt-BR"), "zh": ("zh-CN",)}
"""Their folders of a language, where these have other names."""
EFFECTS = {"moves": 0.0, "asks": 0.2, "changes something for good": 0.0}
"""What none may have, in percent."""


def main() -> int:
    """Print the figures, and each sentence that has an effect."""
    return printed("home_sentences", lambda: _judged(1))


def measure(quick: bool = False) -> Measured:
    """All languages. Raises `NotHere` without the sentences or a model."""
    return Measured(figures=_judged(16 if quick else 1).figures)


def _judged(every: int) -> Measured:
    try:
        robot, effects, lines = Robot("robot-apartment"), Counter[str](), []
        for code in LANGUAGES:
            robot.speak(code)
            for text in sorted(set(_sentences(code)))[::every]:
                effect = robot.effect(Transcript(text, 1.0))
                effects[effect] += 1
                if effect in EFFECTS:
                    lines.append(f"{code}: {text}: {effect}")
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    figures = tuple(
        Figure.share(
            f"home.{effect.split()[0]}", TABLE, "sixteen languages", effects[effect],
            effects.total(), column=effect, wanted=wanted,
        )
        for effect, wanted in EFFECTS.items()
    )  # fmt: skip
    return Measured(figures=figures, notes={TABLE: tuple(lines)})


def _sentences(code: str) -> Iterator[str]:
    folder = Path(os.environ.get(FOLDER, ""))
    if FOLDER not in os.environ or not (folder / "en").is_dir():
        raise NotHere(f"{FOLDER} names no folder with Home Assistant's test sentences")
    for theirs in THEIRS.get(code, (code,)):
        for file in sorted((folder / theirs).rglob("*.yaml")):
            content = yaml.safe_load(file.read_text("utf-8"))
            for one in content.get("tests") or ():
                yield from one["sentences"]


if __name__ == "__main__":
    sys.exit(main())
