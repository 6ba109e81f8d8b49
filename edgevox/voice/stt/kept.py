"""Speech to text that stores each utterance and its transcript."""

import json
import os
import re
import threading
import wave
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger, worth_a_line
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.speech_to_text import SpeechToText, Transcript

log = get_logger(__name__)


MOST_UTTERANCES = 200
MOST_BYTES = 100_000_000
"""The oldest are deleted first, so that there are never more, nor larger ones together."""

_NUMBERS = 1_000_000
_OURS = re.compile(r"heard-\d{8}T\d{6}Z-\d{6}\.(?:wav|json)")


class KeptAudio:
    """A bounded folder of utterances. May be used from any thread.

    Raises `InvalidValue` for a folder that cannot be written. Other files in the folder are left
    alone.
    """

    def __init__(
        self,
        folder: Path,
        *,
        most_utterances: int = MOST_UTTERANCES,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        self.folder = folder.expanduser()
        self._most_utterances, self._most_bytes = most_utterances, most_bytes
        self._lock = threading.Lock()
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if not os.access(self.folder, os.W_OK | os.X_OK):
                raise PermissionError(0, "Permission denied")
            self._number = max((_number(one) for one in self._names()), default=0)
        except OSError as error:
            reason = f"a folder that can be written ({error.strerror})"
            raise InvalidValue("keep_audio", str(folder), reason) from None

    def keep(self, samples: Samples, about: Mapping[str, object]) -> Path:
        """Write an utterance at 16 kHz and its facts; return the WAV file.

        Raises `OSError`, and leaves nothing of it then.
        """
        with self._lock:
            self._number += 1
            now = datetime.now(UTC)
            stem = f"heard-{now:%Y%m%dT%H%M%SZ}-{self._number % _NUMBERS:06}"
            line = {"at": now.isoformat(timespec="milliseconds"), **about}
            try:
                self._write(f"{stem}.json", (json.dumps(line, ensure_ascii=False) + "\n").encode())
                path = self._write_wav(f"{stem}.wav", samples)
            except OSError:
                self._delete(stem)
                raise
            self._delete_oldest()
            return path

    def _write(self, name: str, data: bytes) -> None:
        with os.fdopen(self._create(name), "wb") as file:
            file.write(data)

    def _write_wav(self, name: str, samples: Samples) -> Path:
        with os.fdopen(self._create(name), "wb") as raw, wave.open(raw, "wb") as file:
            file.setnchannels(1)
            file.setsampwidth(2)
            file.setframerate(RATE_HZ)
            file.writeframes(samples.astype("<i2").tobytes())
        return self.folder / name

    def _create(self, name: str) -> int:
        """A new file and no other: a link of that name is not followed."""
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
        return os.open(self.folder / name, flags, 0o600)

    def _delete_oldest(self) -> None:
        stems: dict[str, int] = {}
        for name in self._names():
            size = (self.folder / name).lstat().st_size
            stem = name.partition(".")[0]
            stems[stem] = stems.get(stem, 0) + size
        total = sum(stems.values())
        for stem in sorted(stems, key=self._age)[:0:-1]:  # the newest stays, however large it is
            if len(stems) <= self._most_utterances and total <= self._most_bytes:
                return
            self._delete(stem)
            total -= stems.pop(stem)

    def _delete(self, stem: str) -> None:
        for suffix in ("wav", "json"):
            (self.folder / f"{stem}.{suffix}").unlink(missing_ok=True)

    def _age(self, stem: str) -> int:
        """Return how many utterances were kept since.

        A robot's clock may go back, the numbers do not.
        """
        return (self._number - _number(stem)) % _NUMBERS

    def _names(self) -> list[str]:
        return [one.name for one in self.folder.iterdir() if _OURS.fullmatch(one.name)]


def _number(name: str) -> int:
    return int(name.partition(".")[0].rpartition("-")[2])


class KeepingSpeechToText:
    """A `SpeechToText` around another one that keeps what it transcribes.

    An utterance that seemed over and went on is kept in both forms. A full disk is logged, and
    transcription goes on.
    """

    def __init__(self, stt: SpeechToText, kept: KeptAudio, clock: Clock | None = None) -> None:
        self._stt = stt
        self._kept = kept
        self._clock = clock or SystemClock()
        self.failed = 0
        """Utterances that could not be kept."""

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        """See `SpeechToText.transcribe`."""
        began_s = self._clock.now()
        try:
            said = self._stt.transcribe(samples, language)
        except Exception as error:
            self._keep(samples, language, began_s, failed=" ".join(str(error).split()))
            raise
        others = [{"text": one.text, "share": round(one.share, 3)} for one in said.others]
        sure = round(said.confidence, 3)
        self._keep(samples, language, began_s, text=said.text, confidence=sure, others=others)
        return said

    def warm_up(self, language: str) -> None:
        """See `SpeechToText.warm_up`."""
        self._stt.warm_up(language)

    def close(self) -> None:
        """See `SpeechToText.close`."""
        self._stt.close()

    def _keep(self, samples: Samples, language: str, began_s: float, **said: object) -> None:
        about = {
            **said,
            "language": language,
            "seconds": round(samples.size / RATE_HZ, 2),
            "stt_s": round(self._clock.now() - began_s, 3),
        }
        try:
            self._kept.keep(samples, about)
        except OSError as error:
            self.failed += 1
            if worth_a_line(self.failed):
                reason = error.strerror or str(error)
                log.warning("audio_not_kept", reason=reason, failed=self.failed)
