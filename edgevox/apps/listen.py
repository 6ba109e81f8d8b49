"""`edgevox listen`: what a microphone hears and what is made of it, live, without an agent.

Its display is one line that is redrawn on a terminal, else a line a second.
"""

import argparse
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Protocol

from edgevox.agent.stop.words import SafetyWords
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.run_program import ShutdownSignals, run_program, set_up_logs
from edgevox.apps.streams import with_streams
from edgevox.core.commands import Command, Heard, StopSpotted
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import WakeWordHeard
from edgevox.core.files.text import one_line
from edgevox.core.settings import Settings, load_settings
from edgevox.ros2 import split_ros_args
from edgevox.voice.audio import FRAME_S
from edgevox.voice.noise_floor import SILENT_DB, HearingMeter, HearingReading
from edgevox.voice.utterance_end import VOICED

if TYPE_CHECKING:
    from edgevox.voice.sources.pushed import Pushed

FLAGS = (
    "audio_in", "wakeword", "wakeword_engine", "language", "keep_audio", "agent_namespace",
    "log_level", "log_format",
)  # fmt: skip
PROGRAM = "edgevox listen"


@with_streams(PROGRAM)
def main(argv: Sequence[str] | None = None) -> int:
    """Listen until the sound is over or somebody ends it; the process's exit code."""
    own, ros = split_ros_args(list(sys.argv[2:] if argv is None else argv))
    arguments = _parser().parse_args(own)

    def prepare() -> Callable[[], bool]:
        settings = load_settings(given_flags(arguments), arguments.config)
        set_up_logs(PROGRAM, settings)
        return lambda: _listen(settings, ros, live=sys.stdout.isatty())

    return run_program(PROGRAM, prepare)


def _listen(settings: Settings, ros_args: Sequence[str], *, live: bool) -> bool:
    with ExitStack() as stack, ShutdownSignals(settings.leave_s):
        listen(stack, settings, write=_write, live=live, ros_args=ros_args)
    return True


def listen(
    stack: ExitStack,
    settings: Settings,
    *,
    write: Callable[[str], object],
    live: bool,
    ros_args: Sequence[str] = (),
) -> None:
    """Listen as the agent does, with its listener, until the source is over.

    A file is heard at the pace of speech if the display is `live`, else as fast as possible. Raises
    `EdgeVoxError` for a part that cannot be opened.
    """
    from edgevox.apps.agent.voice import open_hearing, open_stop_detector, open_wakeword
    from edgevox.core.bus import Bus
    from edgevox.voice.listener import Listener
    from edgevox.voice.sources.open_source import WavFiles, open_source
    from edgevox.voice.sources.pushed import Pushed
    from edgevox.voice.vad import open_vad

    wakeword = open_wakeword(settings)
    if wakeword:
        stack.callback(wakeword.close)
    hearing = open_hearing(stack, settings)
    source = open_source(settings.audio_in, paced=live)
    stack.callback(source.close)
    if isinstance(source, Pushed):
        _connect(stack, source, settings, ros_args)
    spotter = open_stop_detector(settings)
    detectors = {"stop": spotter, "wake": wakeword}
    here = {name: one for name, one in detectors.items() if one}
    view, bus = ListenView(write, live=live, detectors=here), Bus()
    stack.callback(view.close)
    bus.subscribe(WakeWordHeard, view.woken)
    stop_words = SafetyWords(settings.language)
    hearing.stop_for(lambda text: stop_words.find(text) is not None)
    listener = Listener(
        source,
        HearingMeter(open_vad(), view.show),
        hearing.stt,
        submit=view.command,
        bus=bus,
        language=lambda: settings.language,
        muted=lambda: False,
        audible=lambda: 0.0,
        wakeword=wakeword,
        is_stop=lambda text: stop_words.find(text) is not None,
        stop_stt=hearing.stop_stt,
        stop_detector=spotter,
        echo="none",
        lossless=isinstance(source, WavFiles),
    )
    stack.callback(listener.close)
    listener.start()
    while not listener.wait_over(1.0) and listener.alive:
        pass


def _connect(
    stack: ExitStack, source: "Pushed", settings: Settings, ros_args: Sequence[str]
) -> None:
    """Have a node of its own fill the source from the topic `audio_in`."""
    try:
        from edgevox.ros2.audio import AudioIn
        from edgevox.ros2.node import RosNode
    except ModuleNotFoundError as error:
        raise EdgeVoxError(f"audio_in ros2: got no module {error.name}, expected ROS 2") from None
    node = RosNode(settings.agent_namespace, ros_args, name="edgevox_listen")
    stack.callback(node.close)
    stack.callback(AudioIn(node.node, source).close)
    node.start()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description="Show what a microphone hears: level, noise, clipping, voice and words.",
        epilog="Settings come from a --config file, then EDGEVOX_* variables, then these flags.",
    )
    add_flags(parser, FLAGS)
    parser.add_argument(
        "--source",
        dest="audio_in",
        default=argparse.SUPPRESS,
        metavar="IN",
        help="the same as --audio-in",
    )
    return parser


def _write(text: str) -> None:
    sys.stdout.write(text)  # noqa: TID251 - a line that is drawn over, of printable text
    sys.stdout.flush()


BAR = 24
REDRAWN_S, TOLD_S = 0.1, 1.0
_CLEAR = "\r\x1b[K"


class Detector(Protocol):
    """A detector of a word by its sound: a `StopDetector`, a `WakeDetector`."""

    @property
    def likelihood(self) -> float:
        """The likelihood that the word was just said, 0 to 1."""


class ListenView:
    """Writes readings as they come, and above them the transcripts. For any thread.

    `live` redraws the last reading. `detectors` are shown by these names.
    """

    def __init__(
        self,
        write: Callable[[str], object],
        *,
        live: bool,
        detectors: Mapping[str, Detector] | None = None,
    ) -> None:
        self._write = write
        self._live = live
        self._detectors = detectors or {}
        self._highest = dict.fromkeys(self._detectors, 0.0)
        self._every_s = REDRAWN_S if live else TOLD_S
        self._due_s = self._every_s
        self._lock = threading.Lock()

    def show(self, meter: HearingMeter) -> None:
        """Show what was measured, if it is time, and the most that each detector thought since."""
        for name, detector in self._detectors.items():
            self._highest[name] = max(self._highest[name], detector.likelihood)
        if meter.heard_s < self._due_s:
            return
        self._due_s = meter.heard_s + self._every_s - FRAME_S / 2
        reading = meter.reading()
        with self._lock:
            line = as_line(reading, self._highest)
            if self._live:
                self._write(f"{_CLEAR}{_bar(reading.level_db)} {line}")
            else:
                self._write(f"{reading.heard_s:7.1f} s  {line}\n")
        self._highest = dict.fromkeys(self._detectors, 0.0)

    def command(self, command: Command) -> None:
        """Tell what was understood, and the stop words that were known by their sound."""
        if isinstance(command, StopSpotted):
            self._tell(f'sounds like "{command.word}"')
        elif isinstance(command, Heard):
            self._tell(f'heard "{command.text}"' if command.text else "no words in what was heard")

    def woken(self, event: WakeWordHeard) -> None:
        """Tell that the wake word was heard."""
        self._tell(f'wake word "{event.phrase}"')

    def close(self) -> None:
        """Leave the line that is drawn anew."""
        if self._live:
            self._write("\n")

    def _tell(self, line: str) -> None:
        with self._lock:
            self._write(f"{_CLEAR if self._live else ''}  {one_line(line)}\n")


def as_line(reading: HearingReading, detectors: Mapping[str, float]) -> str:
    """A reading in words and figures, then what each detector thought at most."""
    noise, floor = reading.signal_to_noise_db, reading.floor_db
    return "  ".join(
        (
            f"level {reading.level_db:4.0f} dB",
            "floor    - " if floor is None else f"floor {floor:4.0f} dB",
            "signal/noise    - " if noise is None else f"signal/noise {noise:3.0f} dB",
            f"clipped {100 * reading.clipped_share:4.1f} %",
            f"voice {reading.voice:4.2f} " + ("speech" if reading.voice >= VOICED else "      "),
            *(f"{name} {likelihood:4.2f}" for name, likelihood in detectors.items()),
        )
    )


def _bar(level_db: float) -> str:
    full = round(BAR * (1 - level_db / SILENT_DB))
    return "[" + "#" * full + " " * (BAR - full) + "]"
