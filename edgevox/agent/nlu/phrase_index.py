"""Finds many phrases in a sentence at once."""

from collections.abc import Iterable, Iterator, Sequence

from edgevox.agent.nlu.tokens import Words


class PhraseIndex:
    """Phrases by their first words, so that a sentence is walked through once."""

    def __init__(self, phrases: Iterable[Words]) -> None:
        self._by_first: dict[str, list[Words]] = {}
        for one in dict.fromkeys(phrases):
            if one:
                self._by_first.setdefault(one[0], []).append(one)

    def find(self, tokens: Sequence[str]) -> Iterator[tuple[int, Words]]:
        """Each phrase that stands there, with where it begins."""
        for at, token in enumerate(tokens):
            for phrase in self._by_first.get(token, ()):
                if tuple(tokens[at : at + len(phrase)]) == phrase:
                    yield at, phrase

    def places(self, tokens: Sequence[str]) -> frozenset[int]:
        """Where the words of these phrases stand."""
        return frozenset(
            at for start, one in self.find(tokens) for at in range(start, start + len(one))
        )

    def starts(self, tokens: Sequence[str]) -> frozenset[int]:
        """Where these phrases begin."""
        return frozenset(start for start, _ in self.find(tokens))
