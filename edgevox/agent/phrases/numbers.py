"""Numbers as people say them, written as digits: small models get them wrong."""

import re
import unicodedata
from functools import lru_cache

from text_to_num import alpha2digit

from edgevox.agent.phrases.load import phrasebook
from edgevox.core.files.text import one_form

_COMMA_BEFORE_UNIT = re.compile(
    r"(?<![\d.,])(\d+),(\d{1,2})(?=\s?(?:[ck]?m|mm|met(?:er|re)s?|[^\W\d_]*met(?:er|re)s?|\u7c73|\u5ea6"
    r"|\u30e1|\u092e\u0940|\u0645\u062a\u0631|degrees?|\u00b0|hours?|minutes?|seconds?)(?![a-z]))",
    re.IGNORECASE,
)
_POINT = re.compile(r"\(\s*-?\d*\.?\d+(?:\s*,\s*-?\d*\.?\d+){1,2}\s*\)")
_MINUS = re.compile(r"(?<![\w.])(?:\u2212\s?|\u2013)(?=\.?\d)")
_BARE_POINT = re.compile(r"(?<![\w.,])(-?)\.(?=\d)")
_AXIS_POINT = re.compile(r"(?<![^\W\d_])([xyz])\.(?=\d)", re.IGNORECASE)
_HYPHEN = re.compile(r"(?<=\d)[-\u2011](?=[^\W\d_])")
_FRACTION = re.compile(r"(?<![\w.,/:])(?:(\d+) )?(\d)[/\u2044]([2-9]|10)(?![\d/:]|[.,]\d)")
_PART = r"-?\d+(?:\.\d+)?"
_EXACT = re.compile(
    r"[(\[{\"'\u00ab\u00bf\u00a1\u201c-\u201f\u300c-\u300f=:;,!?\u2014\u3001\u3002\u060c]*"
    rf"{_PART}(?:[,;]{_PART})*"
    r"[%\u00b0\u00ba]?[\s.,:;!?)\]}\u00bb\u201c-\u201f\u300c-\u300f\u2026\u3001\u3002\u060c\u061b\u061f\u0964]*"
)
_RUN = re.compile(r"(?:(?![^\W\d_])\S)*\d(?:(?![^\W\d_])\S)*")
_SIGNS = r"/*^~#$\u20ac\u00a3\u00a5+\u00b1\u00d7\u00f7<>\u2248\u2260\u2264\u2265\u221a\u2044\u2212"
_RANGE = r"[\d\u4e00\u4e8c\u4e09\u56db\u4e94\u516d\u4e03\u516b\u4e5d]\u3001\d"
"""Two or three, as Japanese says it."""
_STRAY = re.compile(
    rf"\d\s*[{_SIGNS}]|[{_SIGNS}]\s*\d|(?<!\S)[-\u2013]\s+\d|\d\s*=|(?<!\S),\d|{_RANGE}"
)
_THOUSANDS = r"(?<![\d.,])[1-9]\d{{0,2}}{mark}\d{{3}}(?!\d)"
_GLUED = re.compile(r"\s*(?<![^\W\d])([xyz])\s*(?=-?\d)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"(?<![\d.,])(\d+),(\d+)(?![\d.,]*\d)")


@lru_cache(maxsize=2048)
def digits(text: str, language: str = "en") -> str:
    """The text with its number words as digits: "minus two and a half" becomes "-2.5".

    Fractions become decimals with a point, all lengths become metres, all angles degrees, and an
    axis is separated from its number ("x2.5", as Whisper writes coordinates). Cached, because
    several readers ask for the same sentence, and each reload of a language's words asks for the
    same words.
    """
    known = phrasebook(language).numbers
    text = _written_out(text)
    if known.library:
        text = str(alpha2digit(text, known.library, 0))
    text = known.words.as_digits(text) if known.words else text
    text = _GLUED.sub(r" \1 ", text).strip()
    comma = _DECIMAL_COMMA if known.decimal_comma else _COMMA_BEFORE_UNIT
    text = comma.sub(r"\1.\2", text)
    for pattern, replacement in known.rules:
        text = pattern.sub(replacement, text)
    for units in (known.angles, known.lengths):
        text = units.converted(text) if units else text
    return text


def is_exact(text: str, language: str = "en") -> bool:
    """True if each number of this text can be read as it is written.

    "1.5.2", "5'", "3-4" and "17:30" are more than the number that stands in them, and "1,500" may
    be two numbers: nothing may be done by a part of one.
    """
    mark = r"\." if phrasebook(language).numbers.decimal_comma else ","
    if re.search(_THOUSANDS.format(mark=mark), text):
        return False
    plain = digits(one_form(text), language)
    return not _STRAY.search(plain) and all(
        _EXACT.fullmatch(_unmarked(one[0])) for one in _RUN.finditer(plain)
    )


def _unmarked(run: str) -> str:
    """Without the accents of a letter before it, which are no letters to `re`."""
    return run.lstrip("".join(one for one in run if unicodedata.category(one)[0] == "M"))


def _axes(point: str) -> str:
    """A point in parentheses with its axes: "(3.2, 0.8)" is "x 3.2 y 0.8"."""
    numbers = [one.strip() for one in point.strip("()").split(",")]
    return " ".join(f"{axis} {one}" for axis, one in zip("xyz", numbers, strict=False))


def _written_out(text: str) -> str:
    """The one spelling of a number: "\u2212.5" is "-0.5", "1/2" "0.5", "2-metre" "2 metre"."""
    if not any(map(str.isdigit, text)):
        return text
    text = _POINT.sub(lambda found: _axes(found[0]), text)
    text = _BARE_POINT.sub(r"\g<1>0.", _MINUS.sub("-", text))
    text = _HYPHEN.sub(" ", _AXIS_POINT.sub(r"\1 0.", text))
    return _FRACTION.sub(
        lambda found: f"{int(found[1] or 0) + int(found[2]) / int(found[3]):.6g}", text
    )
