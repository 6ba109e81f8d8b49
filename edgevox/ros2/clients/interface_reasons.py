"""Why an interface of the robot did not do what was asked, in the languages of the robot."""

from pathlib import Path

from edgevox.agent.own_phrases import OwnPhrases
from edgevox.core.reason import Reason

_PHRASES = OwnPhrases(Path(__file__).parent / "phrases")


def interface_reason(code: str, *, what: str) -> Reason:
    """The reason of this code; `what` is the interface, by its name."""
    return _PHRASES.because(code, what=what.strip("~/").replace("_", " ").replace("/", " "))
