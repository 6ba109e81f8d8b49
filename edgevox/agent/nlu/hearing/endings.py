"""Endings: are the words a whole command, may they go on, or do they break off?"""

from collections.abc import Callable

from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.nlu.templates import RefusedCommand
from edgevox.agent.phrases.tables import Hearing
from edgevox.agent.text.spelling import key
from edgevox.core.speech import Ending


class Endings:
    """Judges endings by the skills' templates and the phrasebook. Any thread may use it.

    `plain` is `Interpreter.plain`, and `hearing` returns the table of the current language. A
    command is whole only if doing it again with more words costs nothing: it is one call, takes no
    free words and changes nothing for good. It may go on if it is still a plain command with one of
    the language's `goes_on` phrases. A language without such phrases has no whole commands.
    """

    def __init__(
        self,
        plain: Callable[[str], Meaning | RefusedCommand | None],
        *,
        is_stop: Callable[[str], bool],
        hearing: Callable[[], Hearing],
    ) -> None:
        self._plain = plain
        self._is_stop = is_stop
        self._hearing = hearing

    def of(self, text: str) -> Ending:
        """The ending of these words."""
        if self._is_stop(text):
            return Ending.FINAL
        hearing = self._hearing()
        if _breaks_off(text, hearing):
            return Ending.BROKEN_OFF
        found = self._plain(text)
        if not (hearing.goes_on and isinstance(found, Meaning) and _repeatable(found)):
            return Ending.OPEN
        said = text.strip().rstrip(".!?,;")
        longer = (self._plain(f"{said} {more}") for more in hearing.goes_on)
        return Ending.MAY_GO_ON if any(isinstance(m, Meaning) for m in longer) else Ending.WHOLE


def _repeatable(meaning: Meaning) -> bool:
    skills = [meaning.agent.every_skill[call.skill] for call in meaning.calls]
    return len(skills) == 1 and not any(one.lasting or one.free_text for one in skills)


def _breaks_off(text: str, hearing: Hearing) -> bool:
    words = key(text)
    return any(words == last or words.endswith(f" {last}") for last in hearing.unfinished)
