"""One answer on its way to the loudspeaker.

It records how much of each sentence was synthesised and played, works out the words that were heard
of a sentence that was cut, and plays a chunk so that the words heard are known to a tenth of a
second.
"""

import re
import threading
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from edgevox.core.cancel import CancelToken
from edgevox.core.log import bound_now, get_logger
from edgevox.core.speech import Spoken
from edgevox.voice.audio import AudioSink, Chunk, Samples, rms

log = get_logger(__name__)


_WORD_END = re.compile(r"\S(?=\s|$)")


def cut_text(sentence: str, share: float, *, spaced: bool = True) -> str:
    """The beginning of a sentence, up to the last word that was whole after `share` of its sound.

    `share` is 0 to 1. Letters stand for time: a word is whole when the share reaches its last
    letter. Without `spaced` words there are no boundaries to be seen, and it is cut at a character.
    """
    if share >= 1.0:
        return sentence
    reached = int(max(0.0, share) * len(sentence) + 1e-9)
    if not spaced:
        return sentence[:reached].rstrip()
    ends = [match.end() for match in _WORD_END.finditer(sentence) if match.end() <= reached]
    return sentence[: ends[-1]] if ends else ""


_CHAR_S, _UNSPACED_CHAR_S = 0.07, 0.2
"""Seconds that a character takes to say, before any synthesis has measured it: in scripts with
spaces, and in those without."""


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
        """Return the share of the sentence that was heard, 0 to 1."""
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
        """Expect this many characters to be synthesised for the rest of the sentence."""
        with self._lock:
            self._lines[line].chars_left = chars
            self._lines[line].spaced = spaced

    def made(self, line: int, seconds: float, silent_end_s: float) -> None:
        """Record a synthesised piece, and the silence at its end."""
        with self._lock:
            self._lines[line].made_s += seconds
            self._lines[line].silent_end_s = silent_end_s

    def said(self, line: int, chars: int) -> None:
        """Record that all sound of this many characters is synthesised."""
        with self._lock:
            self._lines[line].made_chars += chars
            self._lines[line].chars_left = max(0, self._lines[line].chars_left - chars)

    def complete(self, line: int) -> None:
        """All sound of the sentence is there."""
        with self._lock:
            self._lines[line].whole = True

    def played(self, line: int, seconds: float) -> None:
        """Record that this much of the sentence was given to the sink."""
        with self._lock:
            self._lines[line].given_s += seconds

    def text(self, unplayed_s: float = 0.0) -> str:
        """Return the words that were heard, if the sink's last `unplayed_s` were not."""
        heard: list[str] = []
        with self._lock:
            for line in reversed(self._lines):
                played_s = max(0.0, line.given_s - unplayed_s)
                unplayed_s = max(0.0, unplayed_s - line.given_s)
                share = line.share(played_s)
                heard.append(cut_text(line.sentence, share, spaced=line.spaced))
        return " ".join(text for text in reversed(heard) if text)


class SpeakingUtterance:
    """An `Utterance`, and what the two threads of the speech output note down about it.

    `say` and `end` hand over to the speech output.
    """

    def __init__(
        self,
        token: CancelToken,
        on_audible: Callable[[], object],
        say: Callable[["SpeakingUtterance", int, str], None],
        end: Callable[["SpeakingUtterance"], None],
    ) -> None:
        self.token = token.child()
        self.ids = bound_now()
        """Log context of its log lines: the turn that it belongs to."""
        self.log = SpokenLog()
        self.synthesis_s = 0.0
        self.played: Samples = np.empty(0, np.int16)
        """The last second of the chunks that were played, for a sound that was held."""
        self._on_audible = on_audible
        self._say, self._end = say, end
        self._first_audible_s: float | None = None
        self._settled = threading.Event()
        self._spoken = Spoken("")

    def say(self, sentence: str) -> None:
        self._say(self, self.log.begin(sentence), sentence)

    def finish(self) -> Spoken:
        self._end(self)
        self._settled.wait()
        return self._spoken

    @property
    def settled(self) -> bool:
        """Whether its outcome is known; none of it plays any more."""
        return self._settled.is_set()

    def audible(self, start_s: float) -> None:
        """Something that can be heard is played from this time on; only the first counts."""
        if self._first_audible_s is not None:
            return
        self._first_audible_s = start_s
        try:
            self._on_audible()
        except Exception:
            log.exception("first_sound_unheeded")

    def settle(self, *, cut: bool, unplayed_s: float = 0.0) -> None:
        """Record the outcome: none of it will be played any more."""
        self._spoken = Spoken(
            self.log.text(unplayed_s),
            cut=cut,
            first_audible_s=self._first_audible_s,
            synthesis_s=self.synthesis_s,
        )
        self._settled.set()
        self.token.detach()


PIECE_S = 0.1
_QUIET = 300
"""About a hundredth of full scale: softer sound is inaudible."""
BACK_S = 0.6
"""Sound that was held begins again at the quietest point of so many seconds before."""
_POINT_S = 0.02
_NO_SAMPLES = np.empty(0, np.int16)


def play_chunk(
    chunk: Chunk,
    line: int,
    utterance: SpeakingUtterance,
    sink: AudioSink,
    held: Callable[[], float | None],
) -> None:
    """Play it in pieces until it is over or cut, and note down what was played.

    `held` waits while the sound is held, and then returns the seconds that were not played; None if
    it was not held.
    """
    rate_hz, samples, at = chunk.rate_hz, chunk.samples, 0
    size = max(1, int(PIECE_S * rate_hz))
    while not utterance.token.cancelled:
        unplayed_s = held()
        if unplayed_s is not None:
            before, utterance.played = utterance.played, _NO_SAMPLES
            samples, at = np.concatenate([before, samples]), at + before.size
            heard = max(0, at - round(unplayed_s * rate_hz))
            again = heard if utterance.token.cancelled else _pause_before(samples, heard, rate_hz)
            utterance.log.played(line, (again - at) / rate_hz)
            at = again
        elif at < samples.size:
            piece = samples[at : at + size]
            start_s = sink.play(Chunk(piece, rate_hz), utterance.token)
            at += piece.size
            utterance.log.played(line, piece.size / rate_hz)
            if len(loud := loud_at(piece)):
                utterance.audible(start_s + float(loud[0]) / rate_hz)
        else:
            utterance.played = np.concatenate([utterance.played, samples])[-rate_hz:]
            return


def _pause_before(samples: Samples, heard: int, rate_hz: int) -> int:
    """Return the sample to go on from: where it was quietest shortly before this one."""
    size = max(1, round(_POINT_S * rate_hz))
    starts = range(max(0, heard - round(BACK_S * rate_hz)), heard, size)
    return min(starts, key=lambda at: rms(samples[at : at + size]), default=heard)


def silent_end_s(chunk: Chunk) -> float:
    """Return the seconds of silence at the chunk's end."""
    loud = loud_at(chunk.samples)
    speech = int(loud[-1]) + 1 if len(loud) else 0
    return (len(chunk.samples) - speech) / chunk.rate_hz


def loud_at(samples: Samples) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the indices of the audible samples, shape (n,)."""
    return np.flatnonzero(np.abs(samples.astype(np.int32)) > _QUIET)
