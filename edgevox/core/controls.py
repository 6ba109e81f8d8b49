"""The controls: settings that can change at run time, in one place for all that change them."""

import threading
from collections.abc import Callable, Mapping, Sequence

from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.events import ControlChanged
from edgevox.core.languages import language_code
from edgevox.core.settings import CONFIRM, Confirm

Value = str | bool
Voices = Callable[[str], Sequence[str]]
"""Returns the voices that this machine has for a language code."""
Deafness = Callable[[str], str]
"""Returns the reason why this machine cannot hear a language code; empty if it can."""


class Controls:
    """Language, voice, muted and confirm. A change is made as a whole or not, and published.

    A change to a language that cannot be heard is refused, because no person could stop the robot
    in it; the language from the start is accepted. An empty voice means the best voice of the
    language. A change of language drops a voice of another language.
    """

    def __init__(
        self,
        bus: Bus,
        *,
        language: str,
        voice: str = "",
        muted: bool = False,
        confirm: Confirm = "unsure",
        voices: Voices,
        deafness: Deafness = lambda _: "",
    ) -> None:
        self._bus = bus
        self._voices = voices
        self._deafness = deafness
        self._lock = threading.RLock()
        self._values: dict[str, Value] = {
            "language": language,
            "voice": "",
            "muted": muted,
            "confirm": confirm,
        }
        self._values = self.check({"voice": voice})

    @property
    def language(self) -> str:
        return str(self._values["language"])

    @property
    def voice(self) -> str:
        """The chosen voice; empty for the language's best."""
        return str(self._values["voice"])

    @property
    def muted(self) -> bool:
        return bool(self._values["muted"])

    @property
    def confirm(self) -> str:
        """The setting for questions before a drive."""
        return str(self._values["confirm"])

    @property
    def voices(self) -> tuple[str, ...]:
        """The voices that this machine has for the language."""
        return tuple(self._voices(self.language))

    def check(self, wanted: Mapping[str, Value]) -> dict[str, Value]:
        """All values after the change. Raises `InvalidValue` if one cannot be honoured."""
        values = {**self._values, **wanted}
        voice = str(values["voice"])
        try:
            language = values["language"] = language_code(str(values["language"]))
        except ValueError as error:
            raise InvalidValue("language", values["language"], str(error)) from None
        if language != self._values["language"] and (why := self._deafness(language)):
            raise InvalidValue("language", language, f"one that can be heard here: {why}")
        if not isinstance(values["muted"], bool):
            raise InvalidValue("muted", values["muted"], "true or false")
        if values["confirm"] not in CONFIRM:
            raise InvalidValue("confirm", values["confirm"], "one of " + ", ".join(CONFIRM))
        known = self._voices(language)
        if voice and voice not in known:
            if "voice" in wanted:
                here = ", ".join(known) or "nothing: no voice of this language is on this machine"
                raise InvalidValue("voice", voice, f"for the language {language} one of {here}")
            values["voice"] = ""
        return values

    def change(self, wanted: Mapping[str, Value]) -> None:
        """Make a change. Raises `InvalidValue`, and then nothing has changed."""
        with self._lock:
            values = self.check(wanted)
            changed = {n: v for n, v in values.items() if v != self._values[n]}
            self._values = values
            for name, value in changed.items():
                self._bus.publish(ControlChanged(name, value))
