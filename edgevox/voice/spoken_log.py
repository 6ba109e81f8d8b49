"""How far an utterance got: what was made of each sentence, and what of it was played."""

import threading
from dataclasses import dataclass, field

from edgevox.voice.cut_text import cut_text

_CHAR_S, _UNSPACED_CHAR_S = 0.07, 0.2
"""How long a character takes to say, where nothing better is known."""


@dataclass(slots=True)
class _SpokenLine:
    """One sentence; all times in seconds of sound."""

    sentence: str
    spaced: bool = True
    chars_left: int = 0
    made_chars: int = 0
    made_s: float = 0.0
    silent_end_s: float = 0.0
    given_s: float = 0.0
    whole: bool = False

    def share(self, played_s: float) -> float:
        """How much of the sentence was heard, 0 to 1."""
        if played_s <= 0.0:
            return 0.0
        char_s = _CHAR_S if self.spaced else _UNSPACED_CHAR_S
        if self.made_chars:
            char_s = self.made_s / self.made_chars
        expected_s = self.made_s if self.whole else self.made_s + self.chars_left * char_s
        speech_s = expected_s - (self.silent_end_s if self.whole else 0.0)
        return 1.0 if played_s >= speech_s - 1e-3 else played_s / speech_s


@dataclass(slots=True)
class SpokenLog:
    """Written by the thread that synthesises and the one that plays."""

    _lines: list[_SpokenLine] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def begin(self, sentence: str) -> int:
        """A sentence of the utterance; its number."""
        with self._lock:
            self._lines.append(_SpokenLine(sentence))
            return len(self._lines) - 1

    def sentence(self, line: int) -> str:
        """A sentence by its number."""
        with self._lock:
            return self._lines[line].sentence

    def expect(self, line: int, chars: int, *, spaced: bool) -> None:
        """So many characters are to be synthesised for the rest of this sentence."""
        with self._lock:
            self._lines[line].chars_left = chars
            self._lines[line].spaced = spaced

    def made(self, line: int, seconds: float, silent_end_s: float) -> None:
        """A piece of sound is there, with so much silence at its end."""
        with self._lock:
            self._lines[line].made_s += seconds
            self._lines[line].silent_end_s = silent_end_s

    def said(self, line: int, chars: int) -> None:
        """All sound of so many characters is there."""
        with self._lock:
            self._lines[line].made_chars += chars
            self._lines[line].chars_left = max(0, self._lines[line].chars_left - chars)

    def complete(self, line: int) -> None:
        """All sound of the sentence is there."""
        with self._lock:
            self._lines[line].whole = True

    def played(self, line: int, seconds: float) -> None:
        """So much of it was given to the sink."""
        with self._lock:
            self._lines[line].given_s += seconds

    def text(self, unplayed_s: float = 0.0) -> str:
        """What was heard, if the last `unplayed_s` of what the sink was given was not."""
        heard: list[str] = []
        with self._lock:
            for line in reversed(self._lines):
                played_s = max(0.0, line.given_s - unplayed_s)
                unplayed_s = max(0.0, unplayed_s - line.given_s)
                share = line.share(played_s)
                heard.append(cut_text(line.sentence, share, spaced=line.spaced))
        return " ".join(text for text in reversed(heard) if text)
