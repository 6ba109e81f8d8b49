"""Phrases of a skill package: a folder of phrasebooks like ours, one TOML file per language.

    PHRASES = OwnPhrases(Path(__file__).parent / "phrases")

    @skill(phrases=PHRASES.of("patrol"))
    def patrol(goal: GoalHandle) -> Result:
        ...
        raise SkillFailed(PHRASES.because("door_shut", room=room))

In a language that it has no file of, it speaks English.
"""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from edgevox.agent.phrases.load import ENGLISH, skill_entries
from edgevox.agent.skills import SkillPhrases
from edgevox.agent.text.reasons import in_words
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES
from edgevox.core.reason import Reason


class OwnPhrases:
    """The tables `skills` and `reasons` of each file, in the form of `edgevox/core/languages`.

    Raises `InvalidValue` for a file that is of no language, for a folder without `en.toml`, and for
    a language that lacks a reason that English has.
    """

    def __init__(self, folder: Path) -> None:
        files = sorted(folder.glob("*.toml"))
        self._by_code = {file.stem: tomllib.loads(file.read_text("utf-8")) for file in files}
        for code in self._by_code:
            if code not in LANGUAGES:
                raise InvalidValue(str(folder), code, "a language: " + ", ".join(LANGUAGES))
        if ENGLISH not in self._by_code:
            raise InvalidValue(str(folder), list(self._by_code), f"{ENGLISH}.toml at least")
        for code in self._by_code:
            missing = self._table(ENGLISH, "reasons").keys() - self._table(code, "reasons").keys()
            if missing:
                raise InvalidValue(f"{folder / code}.toml", "no " + min(missing), "a reason")

    def of(self, name: str) -> Mapping[str, SkillPhrases]:
        """The phrases of the skill of this name, by language."""
        entries = {code: skill_entries(self._table(code, "skills")) for code in self._by_code}
        return {code: skills[name] for code, skills in entries.items() if name in skills}

    def because(self, code: str, /, **values: str) -> Reason:
        """The reason of this code. Raises `KeyError` for one that `en.toml` does not have."""
        sentences = {one: self._table(one, "reasons")[code] for one in self._by_code}
        return Reason(in_words(sentences[ENGLISH], values), code, values, sentences)

    def _table(self, code: str, name: str) -> Mapping[str, Any]:
        table: Mapping[str, Any] = self._by_code[code].get(name, {})
        return table
