"""The numbers of a sentence that only programs have: "twice", "half an hour", 五分."""

import re

from edgevox.agent.programs.program_phrases import ProgramPhrases

_DIGITS = {character: value for value, character in enumerate("零一二三四五六七八九")}
_DIGITS |= {"\N{IDEOGRAPHIC NUMBER ZERO}": 0, "两": 2, "兩": 2}
_TENS = {"十": 10, "百": 100}
_NUMERAL = f"[{''.join(_DIGITS)}{''.join(_TENS)}]+"


def rewritten(text: str, phrases: ProgramPhrases) -> str:
    """The same text with these numbers as digits, and what the language rewrites rewritten."""
    if phrases.units:
        ahead = f"(?<={phrases.ahead}){_NUMERAL}|(?!{phrases.ahead})" if phrases.ahead else ""
        numerals = rf"{ahead}{_NUMERAL}(?=\s*(?:{phrases.units}))"
        text = re.sub(numerals, lambda match: str(numeral(match[0])), text)
    if phrases.words:
        text = phrases.words.as_digits(text)
    for pattern, replacement in phrases.rewrite:
        text = pattern.sub(replacement, text)
    return text


def numeral(written: str) -> int:
    """The value of a Chinese or Japanese numeral up to 999."""
    total, current = 0, 0
    for character in written:
        if character in _TENS:
            total += (current or 1) * _TENS[character]
            current = 0
        else:
            current = _DIGITS[character]
    return total + current
