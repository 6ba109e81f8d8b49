"""The status of hearing and speaking: the components `audio`, `stt` and `tts`."""

from typing import TYPE_CHECKING

from edgevox.core.clock import Clock
from edgevox.core.controls import Controls
from edgevox.core.languages import LANGUAGES
from edgevox.core.servers.health import ServerHealth
from edgevox.core.status import (
    Finding,
    Gauges,
    HealthCheck,
    Level,
    RecentIncrease,
    Status,
    fault_of,
    lives,
)
from edgevox.voice.audio import AudioSink, AudioSource
from edgevox.voice.listener import Listener
from edgevox.voice.speech_output import SpeechOutput
from edgevox.voice.stt.speech_to_text import SpeechToText

if TYPE_CHECKING:
    from edgevox.voice.remote.shared_hearing import SharedSpeechToText
    from edgevox.voice.remote.shared_speech import SharedSpeech

SLOW_S = 3.0
"""A person who waits longer than this to be understood, and longer than they spoke, says it
again."""
ESPEAK = "espeak"


class AudioComponent:
    """A device that was asked for and is not there is an error, lost frames are a warning."""

    name = "audio"

    def __init__(
        self,
        source: AudioSource,
        sink: AudioSink,
        listener: Listener,
        speech_output: SpeechOutput,
        *,
        controls: Controls,
        gauges: Gauges,
        clock: Clock | None = None,
    ) -> None:
        self._source, self._sink, self._listener = source, sink, listener
        self._controls, self._gauges = controls, gauges
        self._losing, self._failing = RecentIncrease(clock), RecentIncrease(clock)
        self.checks = (
            HealthCheck("listener", lives(lambda: listener.alive)),
            HealthCheck("speech_output", lives(lambda: speech_output.alive)),
        )

    def status(self) -> Status:
        """Return the current status."""
        source_fault, sink_fault = fault_of(self._source), fault_of(self._sink)
        faults = {check.name: check.said() for check in self.checks}
        faults |= {"microphone": source_fault, "loudspeaker": sink_fault}
        found = [Finding(Level.ERROR, f"{what}: {why}") for what, why in faults.items() if why]
        dropped = int(getattr(self._source, "dropped", 0))  # of one that can lose any
        if doubt := getattr(self._source, "doubt", ""):
            found.append(Finding(Level.WARN, f"{self._source.name}: {doubt}"))
        if self._losing.grew(dropped):
            found.append(Finding(Level.WARN, f"frames are dropped unheard, {dropped} by now"))
        if self._failing.grew(failed := self._listener.failed):
            text = f"what was heard was lost for a fault, {failed} times by now; the log says why"
            found.append(Finding(Level.ERROR, text))
        muted = self._controls.muted
        return Status.judged(
            self.name,
            found,
            well="muted" if muted else "hears and speaks",
            source=self._source.name,
            source_state="retrying" if source_fault else "open",
            sink=self._sink.name,
            sink_state="retrying" if sink_fault else "open",
            level=self._gauges.level,
            muted=muted,
            dropped_frames=dropped,
            failed_frames=failed,
        )


class SttComponent:
    """Status of speech to text: an utterance lost to a fault is an error.

    Slowness or a flood, a warning.
    """

    name = "stt"
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self,
        stt: SpeechToText,
        listener: Listener,
        controls: Controls,
        clock: Clock | None = None,
        shared: "SharedSpeechToText | None" = None,
    ) -> None:
        self._stt, self._transcriber, self._controls = stt, listener.transcriber, controls
        self._shared = shared
        self._failing, self._refusing = RecentIncrease(clock), RecentIncrease(clock)

    def status(self) -> Status:
        """Return the current status."""
        last_s, sound_s = self._transcriber.last or (None, None)
        failed, refused = self._transcriber.failed, self._transcriber.refused
        language, found = self._controls.language, []
        if fault := fault_of(self._stt):
            found.append(Finding(Level.ERROR, fault))
        if self._failing.grew(failed):
            text = f"an utterance could not be understood, {failed} by now; the log says why"
            found.append(Finding(Level.ERROR, text))
        if self._refusing.grew(refused):
            text = f"more is said than can be understood, {refused} utterances refused by now"
            found.append(Finding(Level.WARN, text))
        if self._shared and (missing := self._shared.on_board_fault):
            level = Level.ERROR if self._shared.health.fault else Level.WARN
            found.append(Finding(level, f"the model on board fails: {missing}"))
        if last_s and last_s > max(SLOW_S, sound_s or 0.0):
            found.append(Finding(Level.WARN, f"slow: the last utterance took {last_s:.1f} s"))
        server = _of_server(self._shared.health if self._shared else None, "hears", found)
        return Status.judged(
            self.name,
            found,
            well="understands",
            model=LANGUAGES[language].stt_model,
            language=language,
            last_s=last_s,
            real_time_factor=last_s / sound_s if last_s and sound_s else None,
            failed=failed,
            refused=refused,
            **server,
        )


class TtsComponent:
    """Status of text to speech.

    Another voice than the wanted one, or a failed voice, is a warning.
    """

    name = "tts"
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self,
        speech_output: SpeechOutput,
        controls: Controls,
        gauges: Gauges,
        clock: Clock | None = None,
        shared: "SharedSpeech | None" = None,
    ) -> None:
        self._speech_output, self._controls, self._gauges = speech_output, controls, gauges
        self._shared = shared
        self._failing = RecentIncrease(clock)

    def status(self) -> Status:
        """Return the current status."""
        synthesiser, found = self._speech_output.synthesiser, []
        voices = LANGUAGES[self._controls.language].voices
        asked = next((one for one in voices if self._controls.voice in ("", one.name)), voices[0])
        last = synthesiser.last[0] if synthesiser.last else None
        if synthesiser.fault:
            found.append(Finding(Level.ERROR, synthesiser.fault))
        if last and last.backend == ESPEAK != asked.backend:
            text = f"espeak-ng speaks instead of {asked.name}; edgevox doctor says what is missing"
            found.append(Finding(Level.WARN, text))
        if self._failing.grew(synthesiser.failures):
            text = f"a voice failed, {synthesiser.failures} times by now; another one speaks"
            found.append(Finding(Level.WARN, text))
        server = _of_server(self._shared.health if self._shared else None, "speaks", found)
        return Status.judged(
            self.name,
            found,
            well="speaks",
            voice=last.name if last else None,
            backend=last.backend if last else None,
            asked=asked.name,
            last_synthesis_s=self._gauges.synthesis_s,
            last_first_audio_s=self._gauges.first_audio_s,
            failed=synthesiser.failures,
            refused=self._speech_output.refused,
            **server,
        )


def _of_server(
    server: ServerHealth | None, does: str, found: list[Finding]
) -> dict[str, str | bool | int]:
    """What is told of a server; that it fails is added to the findings."""
    if server is None:
        return {}
    if server.fault:
        text = f"{server.server} fails: {server.fault}; what is on board {does}"
        found.append(Finding(Level.WARN, text))
    where = "on board" if server.resting else "endpoint"
    return {"endpoint": server.server, "answers": where, **server.figures()}
