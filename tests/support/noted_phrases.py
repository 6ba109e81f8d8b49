"""Which sentences a robot said, by their keys: whoever makes the words better breaks no test."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.core.reason import Reason


class Noted:
    """What was put into words: of each sentence its key in `[say]`, of each reason its code."""

    def __init__(self) -> None:
        self._texts: list[tuple[str, str, str]] = []

    def add(self, language: str, key: str, text: str) -> str:
        self._texts.append((language, key, text))
        return text

    def keys_in(self, answer: str, language: str) -> set[str]:
        """The keys of what the phrasebook of this language said, and is a part of this answer."""
        said = _plain(answer)
        ours = [(key, text) for code, key, text in list(self._texts) if code == language]
        return {key for key, text in ours if text and _plain(text) in said}


def _plain(text: str) -> str:
    """Without its last full stop and its spaces: sentences are joined by one in every language."""
    return "".join(text.rstrip(".。।").split())


@contextmanager
def noted_phrases() -> Iterator[Noted]:
    """Notes what all phrasebooks say, as long as it is open."""
    noted, say, reason = Noted(), Phrasebook.say, Phrasebook.reason

    def noted_say(book: Phrasebook, name: str, **values: Any) -> str:
        return noted.add(book.code, name, say(book, name, **values))

    def noted_reason(book: Phrasebook, why: Reason) -> str:
        return noted.add(book.code, why.code, reason(book, why))

    Phrasebook.say, Phrasebook.reason = noted_say, noted_reason
    try:
        yield noted
    finally:
        Phrasebook.say, Phrasebook.reason = say, reason
