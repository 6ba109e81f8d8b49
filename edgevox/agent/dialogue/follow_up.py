"""Follow-ups: what a person may say to the robot without the wake word, shortly after it spoke.

People do not say a name again to answer a question. But in a room with a television or with other
people, most words after an answer are not for the robot. So words without the wake word count only
if they answer its question, correct it or are a plain command; whatever else was said, the robot
stays silent.
"""

from collections.abc import Callable

from edgevox.agent.dialogue.question import OpenQuestion
from edgevox.core.clock import Clock

SURE_FROM = 0.6
"""Confidence of a transcript below which unaddressed words do not count."""


class FollowUps:
    """Implements `core.speech.FollowUp` for a conversation. Any thread may use it.

    `follows` tells whether words answer, correct or command. `within_s` is how long after a spoken
    answer they may begin; 0 turns all follow-ups off. A question takes answers for as long as it is
    open. Only words that were spoken to the robot are answered so: after typed ones nobody is near.
    """

    def __init__(
        self,
        question: OpenQuestion,
        follows: Callable[[str], bool],
        clock: Clock,
        *,
        within_s: float,
    ) -> None:
        self._question = question
        self._follows = follows
        self._clock = clock
        self._within_s = within_s
        self.close()

    def open(self, *, asked: bool) -> None:
        """Await a follow-up from now on: a spoken turn is over; `asked` if it asked a question."""
        self._answered_s, self._asked = self._clock.now(), asked

    def close(self) -> None:
        """Await none: the robot was stopped."""
        self._answered_s, self._asked = float("-inf"), False

    def awaits(self, began_s: float, ended_s: float) -> bool:
        """See `FollowUp.awaits`."""
        if not self._within_s:
            return False
        if self.asked(ended_s):
            return True
        return self._answered_s <= began_s <= self._answered_s + self._within_s

    def asked(self, ended_s: float) -> bool:
        """See `FollowUp.asked`."""
        return self._asked and self._question.is_answered_at(ended_s)

    def takes(self, text: str, confidence: float, began_s: float, ended_s: float) -> bool:
        """See `FollowUp.takes`."""
        return confidence >= SURE_FROM and self.awaits(began_s, ended_s) and self._follows(text)
