"""The components `stt` and `tts`: words from sound, and sound from words."""

from dataclasses import dataclass

from edgevox.ops.diagnostics.component import Component, Finding, Level, component

SLOW_S = 3.0
"""Who waits longer to be understood, and longer than he spoke, says it again."""
ESPEAK = "espeak"


@dataclass(frozen=True, slots=True)
class Hearing:
    """What is known of speech to text.

    `failing` and `refusing` are about the last seconds; `trouble` is why nothing is understood.
    """

    model: str
    language: str
    last_s: float | None = None
    last_sound_s: float | None = None
    failed: int = 0
    failing: bool = False
    refused: int = 0
    refusing: bool = False
    trouble: str = ""

    @property
    def real_time_factor(self) -> float | None:
        """Seconds of work a second of sound; None while nothing was understood yet."""
        return self.last_s / self.last_sound_s if self.last_s and self.last_sound_s else None


def stt(seen: Hearing) -> Component:
    """What could not be understood for a fault is an error, being slow or flooded a warning."""
    found = []
    if seen.trouble:
        found.append(Finding(Level.ERROR, seen.trouble))
    if seen.failing:
        text = f"an utterance could not be understood, {seen.failed} by now; the log says why"
        found.append(Finding(Level.ERROR, text))
    if seen.refusing:
        text = f"more is said than can be understood, {seen.refused} utterances refused by now"
        found.append(Finding(Level.WARN, text))
    if seen.last_s and seen.last_s > max(SLOW_S, seen.last_sound_s or 0.0):
        found.append(Finding(Level.WARN, f"slow: the last utterance took {seen.last_s:.1f} s"))
    return component(
        "stt",
        found,
        well="understands",
        model=seen.model,
        language=seen.language,
        last_s=seen.last_s,
        real_time_factor=seen.real_time_factor,
        failed=seen.failed,
        refused=seen.refused,
    )


@dataclass(frozen=True, slots=True)
class Speaking:
    """What is known of text to speech. `asked` is the voice that should speak, `voice` the one
    that spoke last or is loaded, None before the first.
    """

    asked: str
    asked_backend: str
    voice: str | None = None
    backend: str | None = None
    last_synthesis_s: float | None = None
    last_first_audio_s: float | None = None
    failed: int = 0
    failing: bool = False
    trouble: str = ""


def tts(seen: Speaking) -> Component:
    """Another voice than the one that was asked for is a warning; so is one that failed."""
    found = []
    if seen.trouble:
        found.append(Finding(Level.ERROR, seen.trouble))
    if seen.voice and seen.backend == ESPEAK != seen.asked_backend:
        text = f"espeak-ng speaks instead of {seen.asked}; edgevox doctor says what is missing"
        found.append(Finding(Level.WARN, text))
    if seen.failing:
        text = f"a voice failed, {seen.failed} times by now; another one speaks"
        found.append(Finding(Level.WARN, text))
    return component(
        "tts",
        found,
        well="speaks",
        voice=seen.voice,
        backend=seen.backend,
        asked=seen.asked,
        last_synthesis_s=seen.last_synthesis_s,
        last_first_audio_s=seen.last_first_audio_s,
        failed=seen.failed,
    )
