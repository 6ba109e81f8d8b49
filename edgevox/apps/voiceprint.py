"""`edgevox voiceprint`: enrol people by their voice, list them, and forget them.

A voice print is biometric data. It stays in a folder of this computer that only its owner may read.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack

from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.folders import voiceprints_folder
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings, load_settings
from edgevox.models import locate
from edgevox.voice.audio import AudioSource, EndOfSound, Frame, Samples
from edgevox.voice.sources.open_source import NONE, ROS2, open_source
from edgevox.voice.utterance_end import Endpointer, SpeechEnded
from edgevox.voice.vad import VoiceDetector, open_vad
from edgevox.voice.voiceprint import ENCODER, SENTENCES, Floats, VoiceEncoder, VoicePrints

OK, FAILED = 0, 1
READ_S = 1.0
SAY = (
    "Please go to the kitchen and look whether the window is open.",
    "Could you come back here in ten minutes and wait at the door?",
    "Tell me what you can see on the table in the living room.",
)
"""Long enough, and with many sounds; any other sentences will do."""


@with_streams("edgevox voiceprint", results=True)
def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 if all is well, else 1 and a line that says why."""
    asked = _parser().parse_args(sys.argv[2:] if argv is None else argv)
    prints = VoicePrints(voiceprints_folder())
    try:
        if asked.command == "enrol":
            enrol(prints, asked.name, load_settings(given_flags(asked), asked.config))
        elif asked.command == "list":
            for name in prints.read():
                show(name)
        elif not prints.forget(asked.name):
            raise EdgeVoxError(f"there is no voice print of {asked.name}")
    except (EdgeVoxError, OSError) as error:
        show(f"edgevox voiceprint: {error}", error=True)
        return FAILED
    return OK


def enrol(prints: VoicePrints, name: str, settings: Settings) -> None:
    """Hear a person say three sentences, and keep their print. Raises `EdgeVoxError`, `OSError`."""
    if settings.audio_in in (NONE, ROS2):
        raise InvalidValue("audio_in", settings.audio_in, "a microphone, a WAV file or a folder")
    encoder = VoiceEncoder(locate(ENCODER))
    with ExitStack() as stack:
        source = open_source(settings.audio_in, paced=False)
        stack.callback(source.close)
        source.start()
        show(f"Say {SENTENCES} sentences, each after the line that asks for it; such as:")
        prints.keep(name, list(_sentences(source, encoder)))
    show(f"{name} is enrolled. `edgevox voiceprint forget {name}` deletes the voice print.")


def _sentences(source: AudioSource, encoder: VoiceEncoder) -> Iterator[Floats]:
    """The vectors of as many utterances as are needed; one that is too short is asked for again."""
    spoken, found = utterances(source, open_vad()), 0
    while found < SENTENCES:
        show(f'{found + 1}. "{SAY[found]}"')
        sound = next(spoken, None)
        if sound is None:
            raise EdgeVoxError(f"the sound ended after {found} of {SENTENCES} sentences")
        vector = encoder.of(sound)
        if vector is None:
            show("That was too short. Please say a whole sentence.")
            continue
        found += 1
        yield vector


def utterances(source: AudioSource, vad: VoiceDetector) -> Iterator[Samples]:
    """What is said, one utterance after the other, until the source is over."""
    endpointer = Endpointer()
    while True:
        try:
            frame: Frame | None = source.read(READ_S)
        except EndOfSound:
            break
        if frame is None:
            continue
        signal = endpointer.push(frame, vad.probability(frame.samples))
        if isinstance(signal, SpeechEnded):
            yield signal.samples
    if last := endpointer.finish():
        yield last.samples


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox voiceprint",
        description="Tell people by their voice: no lock, see docs/policy.md.",
    )
    commands = parser.add_subparsers(dest="command", required=True)
    take = commands.add_parser("enrol", help="enrol a person, or enrol them again")
    take.add_argument("name", metavar="NAME", help="the person's name")
    add_flags(take, ("audio_in",))
    commands.add_parser("list", help="the names of all who are enrolled")
    forget = commands.add_parser("forget", help="delete a person's voice print")
    forget.add_argument("name", metavar="NAME", help="the person's name")
    return parser
