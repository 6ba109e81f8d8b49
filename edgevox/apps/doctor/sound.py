"""The checks of sound devices, by PortAudio, and of espeak-ng."""

from collections.abc import Sequence
from pathlib import Path

from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, skipped, warning
from edgevox.core.errors import install_extra
from edgevox.voice.devices import DeviceMissing, devices
from edgevox.voice.echo.canceller import open_engine
from edgevox.voice.sinks.open_sink import NONE, ROS2

WORDS = {"inputs": "microphone", "outputs": "loudspeaker"}


def probe_sound() -> Facts:
    """List devices; in its own process, since PortAudio's back ends may hang, and print."""
    try:
        inputs, outputs = devices("input"), devices("output")
    except DeviceMissing as missing:
        return {"library": f"{missing}"}
    return {
        "library": "",
        "inputs": [one.name for one in inputs],
        "outputs": [one.name for one in outputs],
    }


def judge_sound(facts: Facts, situation: Situation) -> CheckVerdict | list[CheckVerdict]:
    """A device that was named and is not there is an error, none at all a warning."""
    settings = situation.settings
    asked = {"inputs": settings.audio_in, "outputs": settings.audio_out}
    devices = {kind: name for kind, name in asked.items() if is_device(name)}
    if settings.text_mode or not devices:
        return skipped("no sound card is asked for")
    if facts["library"]:
        return error(facts["library"], "install it, or use --text-mode")
    return [_judge(WORDS[kind], name, facts[kind]) for kind, name in devices.items()]


def is_device(spec: str) -> bool:
    """Return whether a setting for sound names a sound card."""
    elsewhere = spec in (NONE, ROS2) or "/" in spec or Path(spec).suffix.lower() == ".wav"
    return not elsewhere


def _judge(word: str, asked: str, here: Sequence[str]) -> CheckVerdict:
    names = ", ".join(here)
    if asked and not any(asked.casefold() in name.casefold() for name in here):
        advice = f"plug it in, or name another; EdgeVox keeps trying the {word} while it runs"
        return error(f"no {word} {asked!r} among: {names or 'none at all'}", advice)
    if not here:
        advice = "plug one in, add this user to the group audio, or use --text-mode"
        return warning(f"no {word}", advice)
    return ok(f"{word}: {asked or names}")


def probe_echo() -> Facts:
    """Load the canceller; in its own process, since it loads a library."""
    try:
        open_engine()
    except ImportError as missing:
        return {"missing": str(missing)}
    return {"missing": ""}


def judge_echo(facts: Facts, situation: Situation) -> CheckVerdict:
    """Judge the canceller.

    The gate, in its place, keeps out the robot's voice and also quiet people.
    """
    if situation.settings.text_mode or situation.settings.echo != "cancel":
        return skipped("no echo canceller is asked for")
    if facts["missing"]:
        found = f"no echo canceller, the gate is used instead: {facts['missing']}"
        return warning(found, install_extra("voice"))
    return ok("the robot's own voice can be cancelled")


def probe_espeak() -> Facts:
    """Speak a word; in its own process, since it loads a library."""
    from edgevox.core.cancel import CancelToken
    from edgevox.voice.tts.espeak import open_espeak
    from edgevox.voice.tts.synthesiser import SynthesisFailed

    try:
        chunk = open_espeak().speak("one", "en-us", CancelToken())
    except SynthesisFailed as failed:
        return {"failed": str(failed), "samples": 0}
    return {"failed": "", "samples": len(chunk.samples)}


def judge_espeak(facts: Facts, situation: Situation) -> CheckVerdict:
    """Judge espeak-ng: it speaks where no other voice does."""
    if facts["failed"] or not facts["samples"]:
        found = f"espeak-ng does not speak: {facts['failed'] or 'it was silent'}"
        advice = "sudo apt install espeak-ng"
        return (skipped if situation.settings.text_mode else warning)(found, advice)
    return ok("espeak-ng speaks if there is no better voice")


def judge_spotter(facts: Facts, situation: Situation) -> CheckVerdict:
    """Stop words are heard by their words all the same."""
    settings = situation.settings
    if settings.text_mode or not settings.stop_spotter:
        return skipped("not asked for")
    if facts["missing"]:
        return warning(f"by their words alone: {facts['missing']}")
    return ok("by their sound and by their words")


def probe_spotter() -> Facts:
    """Find out whether the stop word spotter's model is here."""
    from edgevox.models import ModelMissing, locate
    from edgevox.voice.stop_spotter.network import ENCODER

    missing = ""
    try:
        locate(ENCODER)
    except ModelMissing as error:
        missing = str(error)
    return {"missing": missing}
