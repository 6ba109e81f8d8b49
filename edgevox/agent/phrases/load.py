"""The loader of phrasebooks.

`phrasebook` reads a language of EdgeVox, from `edgevox/core/languages`; `OwnPhrases` the languages
of a package of skills.
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.phrases.tables import (
    AnswerWords,
    Everyday,
    Hearing,
    HouseAct,
    Numbers,
    ProgramPhrases,
    Rewriting,
    number_words,
    units,
)
from edgevox.agent.skills import Example, SkillPhrases
from edgevox.agent.text.reasons import in_words
from edgevox.agent.text.spelling import key
from edgevox.agent.text.words import word_of
from edgevox.core.errors import InvalidValue
from edgevox.core.files.text import one_form
from edgevox.core.languages import LANGUAGES, language_file
from edgevox.core.reason import Reason

_FIELDS = {"not": "not_", "or": "or_"}
"""Fields of `AnswerWords` that are no names in Python without a mark."""

ENGLISH = "en"
"""The language that skills and robots speak by themselves, and that all others fall back to."""


@cache
def phrasebook(code: str) -> Phrasebook:
    """The phrasebook of a language; what its file lacks falls back to English.

    Raises `InvalidValue` for a language that there is no file of.
    """
    return _book(code, language_file(code), None if code == ENGLISH else phrasebook(ENGLISH))


def _book(code: str, data: Mapping[str, Any], fallback: Phrasebook | None) -> Phrasebook:
    ors = data.get("answers", {}).get("or", ())
    hearing = _hearing(data.get("hear", {}), ors, spaced=LANGUAGES[code].spaced)
    return Phrasebook(
        code=code,
        name=LANGUAGES[code].name,
        sentences=data.get("say", {}),
        hearing=hearing,
        numbers=_numbers(data.get("numbers", {}), hearing),
        rules=data.get("rules", {}),
        words={key(name): word_of(one) for name, one in data.get("words", {}).items()},
        unknown=word_of(data.get("unknown")),
        own_names={one: word_of(forms) for one, forms in data.get("own_names", {}).items()},
        skills=skill_entries(data.get("skills", {})),
        reasons=data.get("reasons", {}),
        arguments=data.get("arguments", {}),
        dialogue={
            name: SkillPhrases(templates=tuple(said))
            for name, said in data.get("dialogue", {}).items()
        }
        | skill_entries(data.get("facts", {})),
        sums={name: tuple(some) for name, some in data.get("sums", {}).items()},
        everyday=tuple(Everyday(*one) for one in data.get("everyday", {}).items())
        or (fallback.everyday if fallback else ()),
        acts={
            name: HouseAct(
                tuple(one["words"]),
                one["cannot"],
                tuple(one.get("by", ())),
                one.get("in_place", False),
                one.get("motion", False),
            )
            for name, one in data.get("acts", {}).items()
        },
        cues={name: tuple(some) for name, some in data.get("cues", {}).items()},
        smoothing=_rewritings(data.get("smoothing", ())),
        answers=_answers(data.get("answers", {})),
        programs=_programs(data.get("programs", {})),
        fallback=fallback,
    )


def _hearing(data: Mapping[str, Any], ors: Sequence[str], *, spaced: bool) -> Hearing:
    return Hearing(
        joints=tuple(data.get("joints", ())),
        articles=tuple(data.get("articles", ())),
        clause_words=frozenset(map(key, (*data.get("clause_words", ()), *(ors if spaced else ())))),
        pair=data.get("pair", "and"),
        percent=data.get("percent", "%"),
        spaced=spaced,
        written=data.get("written", ""),
        reserved=tuple(data.get("reserved", ())),
        places=tuple(data.get("places", ())),
        unfinished=tuple(map(key, data.get("unfinished", ()))),
        goes_on=tuple(data.get("goes_on", ())),
        hesitations=tuple(data.get("hesitations", ())),
        back_channels=tuple(data.get("back_channels", ())),
        openers=tuple(data.get("openers", ())),
        denials_follow=data.get("denials_follow", False),
    )


def _answers(data: Mapping[str, Any]) -> AnswerWords:
    return AnswerWords(**{_FIELDS.get(name, name): tuple(w) for name, w in data.items()})


def _numbers(data: Mapping[str, Any], hearing: Hearing) -> Numbers:
    rows = data.get("lengths", ())
    any_length = "|".join(pattern for pattern, _ in rows)
    convert = partial(units, joint=hearing.pair, spaced=hearing.spaced)
    rules = [
        (one.replace("{length}", f"(?:{any_length})"), to) for one, to in data.get("rules", ())
    ]
    return Numbers(
        decimal_comma=data.get("decimal_comma", False),
        rules=_rewritings(rules),
        words=number_words(data.get("words", {}), data.get("units", "")),
        lengths=convert(rows, data["metres"]) if rows else None,
        angles=convert(data["angles"], data["degrees"]) if "angles" in data else None,
        library=data.get("library", ""),
    )


def _programs(data: Mapping[str, Any]) -> ProgramPhrases:
    return ProgramPhrases(
        templates={kind: tuple(some) for kind, some in data.get("templates", {}).items()},
        rules=data.get("rules", {}),
        rewrite=_rewritings(data.get("rewrite", ())),
        words=number_words(data.get("words", {})),
        units=data.get("units", ""),
        ahead=data.get("ahead", ""),
        go=data.get("go", ""),
        between=tuple(data.get("between", ())),
        me=tuple(data.get("me", ())),
        names={kind: tuple(some) for kind, some in data.get("names", {}).items()},
    )


def skill_entries(table: Mapping[str, Mapping[str, Any]]) -> dict[str, SkillPhrases]:
    """The phrases of skills, from a table `skills`.

    An entry that is `like` another takes the keys that it lacks from that one, and has `more`
    templates beside those.
    """
    return {
        name: _skill_phrases({**table.get(one.get("like", ""), {}), **one})
        for name, one in table.items()
    }


def _skill_phrases(data: Mapping[str, Any]) -> SkillPhrases:
    examples = [dict(one) for one in data.get("examples", ())]
    return SkillPhrases(
        can=data.get("can", ""),
        actions=_several(data.get("action", ())),
        orders=_several(data.get("order", ())),
        templates=(*data.get("templates", ()), *data.get("more", ())),
        asks=tuple(data.get("asks", ())),
        says=_several(data.get("says", ())),
        done=_several(data.get("done", ())),
        examples=tuple(Example(one.pop("sentence"), one) for one in examples),
        arguments=data.get("arguments", {}),
        words=data.get("words", {}),
    )


def _several(data: Any) -> tuple[str, ...]:
    return (data,) if isinstance(data, str) else tuple(data)


def _rewritings(data: Any) -> tuple[Rewriting, ...]:
    return tuple(
        (re.compile(one_form(pattern), re.IGNORECASE), replacement) for pattern, replacement in data
    )


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
