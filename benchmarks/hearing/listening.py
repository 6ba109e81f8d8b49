"""What listening costs: CPU in silence, and whether an hour of it leaves anything behind."""

import gc
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from support.recordings import InMemory

from edgevox.core.bus import Bus
from edgevox.core.commands import Heard
from edgevox.models import locate
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.listener import Listener
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.stt.speech_to_text import SpeechToText, Transcript
from edgevox.voice.vad import open_vad
from edgevox.voice.word_detection import WakeDetector


@dataclass(frozen=True, slots=True)
class Listening:
    """What listening to so many seconds of sound took, and what it left behind."""

    sound_s: float
    cpu_s: float
    utterances: int
    memory_growth_kib: int
    thread_growth: int
    slowest_stt_s: float

    @property
    def share_of_a_core(self) -> float:
        return self.cpu_s / self.sound_s


class NoWords:
    """Recognises nothing: what listening costs beside that."""

    def transcribe(self, samples: Samples, language: str) -> Transcript:  # noqa: ARG002
        return Transcript("")

    def warm_up(self, language: str) -> None: ...

    def close(self) -> None: ...


def quiet_room(seconds: float) -> Samples:
    """Noise at -70 dB of full scale."""
    return np.random.default_rng(7).normal(0, 10, int(seconds * RATE_HZ)).astype(np.int16)


def listen(
    stt: SpeechToText, sound: Samples, *, times: int = 1, wakeword: WakeDetector | None = None
) -> Listening:
    """Listen to a sound, `times` over, as fast as it goes."""
    source, slowest, count = InMemory(sound, times=times), [0.0], [0]

    def submit(command: object) -> None:
        if isinstance(command, Heard):
            slowest[0] = max(slowest[0], command.stt_s)
            count[0] += 1

    spotter = open_stop_spotter(locate(ENCODER))
    spotter.warm_up()
    gc.collect()
    threads, resident, cpu_s = threading.active_count(), resident_kib(), time.process_time()
    listener = Listener(
        source,
        open_vad(),
        stt,
        submit=submit,
        bus=Bus(),
        language=lambda: "en",
        muted=lambda: False,
        audible=lambda: 0.0,
        wakeword=wakeword,
        stop_detector=spotter,
        echo="cancel",
        played=PlayedSound(),
        lossless=True,
    )
    listener.start()
    listener.wait_over()
    listener.close()
    gc.collect()
    return Listening(
        sound_s=source.heard_s,
        cpu_s=time.process_time() - cpu_s,
        utterances=count[0],
        memory_growth_kib=resident_kib() - resident,
        thread_growth=threading.active_count() - threads,
        slowest_stt_s=slowest[0],
    )


def spotting(seconds: float, voice: float) -> float:
    """Of a core, what the stop word spotter alone takes for sound that is so likely a voice."""
    spotter = open_stop_spotter(locate(ENCODER))
    spotter.warm_up()
    frames = int(seconds / FRAME_S)
    sound = np.random.default_rng(1).normal(0, 500, frames * FRAME_SAMPLES).astype(np.int16)
    cpu_s = time.process_time()
    for frame in np.split(sound, frames):
        spotter.heard(frame, voice)
    return (time.process_time() - cpu_s) / (frames * FRAME_S)


def resident_kib() -> int:
    """Memory that this process has, in KiB."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS"))
