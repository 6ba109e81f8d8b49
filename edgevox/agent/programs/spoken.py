"""What people ask of the programs that are kept: which there are, and to forget some."""

from collections.abc import Callable, Sequence

from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.phrase_forms import continued
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.programs.kept import Kept
from edgevox.agent.programs.matching import meant
from edgevox.agent.programs.patterns import patterns_of, spelled
from edgevox.agent.reasons import because
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import ProgramStatus

_KINDS = ("list", "forget_all", "forget")


class ProgramQuestions:
    """Answers them, in the language of `phrases`; what `is_plain` is a command, and no question."""

    def __init__(
        self,
        programs: Programs,
        *,
        phrases: Callable[[], Phrasebook],
        is_plain: Callable[[str], bool],
    ) -> None:
        self._programs = programs
        self._phrases = phrases
        self._is_plain = is_plain

    def answer(self, text: str, turn: Turn) -> bool:
        """Answer what is asked of the programs; False if nothing is."""
        phrases = self._phrases()
        codes = dict.fromkeys((phrases.code, ENGLISH))
        asked = [(book, *one) for book in map(phrasebook, codes) for one in _asked(text, book)]
        if not asked or self._is_plain(text):
            return False
        for book, kind, slots in asked:
            if said := _answer(kind, slots.get("what", ""), self._programs, phrases, book):
                turn.say(said)
                return True
        return False


def _answer(kind: str, what: str, programs: Programs, phrases: Phrasebook, book: Phrasebook) -> str:
    """What is said to it; empty where something else must be meant."""
    kept = programs.kept
    if kind == "list":
        return listing(programs, phrases)
    some: Sequence[Kept] | None = kept if kind == "forget_all" else meant(what, kept, book)
    if some is None:
        return ""
    if not some:
        return phrases.say("program_which", orders=listing(programs, phrases))
    told = " ".join(programs.told(one) for one in some)
    programs.forget(some, because("called_off"))
    return phrases.say("program_forgotten", orders=told)


def listing(programs: Programs, phrases: Phrasebook) -> str:
    """All programs in words."""
    told = [_told(one, programs, phrases) for one in programs.kept]
    if not told:
        return phrases.say("program_none")
    return phrases.say("program_listed", orders=" ".join(told))


def _told(one: Kept, programs: Programs, phrases: Phrasebook) -> str:
    order = programs.told(one)
    if one.status is ProgramStatus.WAITING:
        return order
    return phrases.say("program_running", order=continued(order))


def _asked(text: str, book: Phrasebook) -> Sequence[tuple[str, dict[str, str]]]:
    words, patterns = spelled(text, book.code), patterns_of(book.code, _KINDS)
    found = ((kind, one.slots(words)) for kind in _KINDS for one in patterns[kind])
    return [(kind, slots) for kind, slots in found if slots is not None]
