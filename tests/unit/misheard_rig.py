"""A conversation that is spoken to, whose words sound as they are written."""

from dialogue_rig import HUNG_S, Rig

from edgevox.core.commands import Heard, Hypothesis


def LETTERS(text, _code):  # noqa: N802 - stands for an engine
    """Letters for phonemes: near enough, and the same on every machine."""
    return text.replace("th", "ð").replace("ch", "ʃ")


class Spoken(Rig):
    """Like `Rig`, and can be spoken to."""

    def __init__(self):
        super().__init__(phonemes=LETTERS)

    def hears(self, text, confidence=1.0, others=()):
        """The first answer to these words, once everything has ended.

        `others` are the texts, shares and confidences of what else may have been said.
        """
        before = len(self.answers)
        instead = tuple(Hypothesis(*one) for one in others)
        self.talk.submit(Heard(text, self.clock.now(), confidence=confidence, others=instead))
        assert self.talk.wait_idle(HUNG_S)
        return self.answers[before].text
