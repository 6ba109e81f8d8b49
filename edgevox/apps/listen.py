"""`edgevox listen`: what a microphone hears and what is made of it, live, without an agent."""

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

from edgevox.agent.stop.words import SafetyWords
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.run_program import ShutdownSignals, run_program, set_up_logs
from edgevox.apps.streams import with_streams
from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import Settings, load_settings
from edgevox.ros2 import split_ros_args

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
    from edgevox.apps.listen_view import ListenView
    from edgevox.core.bus import Bus
    from edgevox.core.events import WakeWordHeard
    from edgevox.voice.listener import Listener
    from edgevox.voice.noise_floor import HearingMeter
    from edgevox.voice.sources.open_source import WavFiles, open_source
    from edgevox.voice.sources.pushed import Pushed
    from edgevox.voice.vad import open_vad

    wakeword = open_wakeword(settings)
    if wakeword:
        stack.callback(wakeword.close)
    stt, _ = open_hearing(stack, settings)
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
    listener = Listener(
        source,
        HearingMeter(open_vad(), view.show),
        stt,
        submit=view.command,
        bus=bus,
        language=lambda: settings.language,
        muted=lambda: False,
        audible=lambda: 0.0,
        wakeword=wakeword,
        is_stop=lambda text: stop_words.find(text) is not None,
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
