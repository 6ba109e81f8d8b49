"""Answers to questions about the conversation: short, and made of what really happened."""

from collections.abc import Callable, Mapping

from edgevox.agent.abilities import abilities
from edgevox.agent.dialogue import Dialogue
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.skills import Skill

MOST_QUOTED = 120
"""So many characters of what somebody said are said back."""
_PLAIN = "template"
"""Who understands what is a plain command."""


class DialogueAnswers:
    """Speaks the language of `phrases`. May be asked from any thread."""

    def __init__(
        self,
        dialogue: Dialogue,
        skills: Mapping[str, Skill],
        phrases: Callable[[], Phrasebook],
    ) -> None:
        self._dialogue = dialogue
        self._skills = skills
        self._phrases = phrases

    def doing(self) -> str:
        """What uses the body now, and how far that is."""
        book, running = self._phrases(), self._dialogue.running()
        if running is None:
            return book.say("idle")
        skill = self._skills[running.skill]
        action = book.acknowledge(skill, running.arguments)
        action = action or book.say("busy", action=book.can(skill))
        if running.progress is None:
            return action
        return book.say("doing", action=action, percent=round(100 * running.progress))

    def why(self) -> str:
        """Which words made the body move last, who understood them, and how sure that was."""
        book, moved = self._phrases(), self._dialogue.moved()
        if moved is None:
            return book.say("nothing_done")
        asked = self._dialogue.exchange(moved.turn)
        if asked is None and moved.turn:  # too much was said since
            return book.say("nothing_done")
        if asked is None or not asked.words:
            return book.say("why_program")
        words = _quoted(asked.meant or asked.words)
        if asked.source == _PLAIN:
            return book.say("why_plain", words=words)
        return book.say("why_read", words=words, percent=round(100 * asked.confidence))

    def heard(self) -> str:
        """What was heard last, before this."""
        book, heard = self._phrases(), self._dialogue.heard()
        return book.say("heard", words=_quoted(heard.words)) if heard else book.say("not_heard")

    def can(self) -> tuple[str, str]:
        """What this robot can do: a few things of it, and all where that is more."""
        book = self._phrases()
        if not self._skills:
            return book.say("no_abilities"), ""
        return abilities(book, list(self._skills.values()))


def _quoted(words: str) -> str:
    words = words.rstrip(".。।")
    return words if len(words) <= MOST_QUOTED else f"{words[:MOST_QUOTED]}…"
