"""Speech to text that keeps what it was given, with the words that it made of it."""

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger, worth_a_line
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.kept_audio import KeptAudio
from edgevox.voice.stt.speech_to_text import SpeechToText, Transcript

log = get_logger(__name__)


class KeepingSpeechToText:
    """Implements `SpeechToText` by another one.

    What may have been a whole utterance and went on is kept too, as it was understood too. A disk
    that is full keeps nobody from being understood: that is logged.
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
