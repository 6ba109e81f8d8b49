"""One answer on its way to the loudspeaker."""

import threading
from collections.abc import Callable

from edgevox.core.cancel import CancelToken
from edgevox.core.log import bound_now, get_logger
from edgevox.core.speech import Spoken
from edgevox.voice.spoken_log import SpokenLog

log = get_logger(__name__)


class SpeakingUtterance:
    """An `Utterance`, and what the two threads of the speech output note down about it.

    `say` and `end` hand over to the speech output.
    """

    def __init__(
        self,
        token: CancelToken,
        on_audible: Callable[[], object],
        say: Callable[["SpeakingUtterance", int, str], None],
        end: Callable[["SpeakingUtterance"], None],
    ) -> None:
        self.token = token.child()
        self.ids = bound_now()
        """What the lines about it belong to: the turn."""
        self.log = SpokenLog()
        self.synthesis_s = 0.0
        self._on_audible = on_audible
        self._say, self._end = say, end
        self._first_audible_s: float | None = None
        self._settled = threading.Event()
        self._spoken = Spoken("")

    def say(self, sentence: str) -> None:
        self._say(self, self.log.begin(sentence), sentence)

    def finish(self) -> Spoken:
        self._end(self)
        self._settled.wait()
        return self._spoken

    @property
    def settled(self) -> bool:
        """Whether it is known what became of it; nothing of it is played any more."""
        return self._settled.is_set()

    def audible(self, start_s: float) -> None:
        """Something that can be heard is played from this time on; only the first counts."""
        if self._first_audible_s is not None:
            return
        self._first_audible_s = start_s
        try:
            self._on_audible()
        except Exception:
            log.exception("first_sound_unheeded")

    def settle(self, *, cut: bool, unplayed_s: float = 0.0) -> None:
        """Nothing more of it will be played."""
        self._spoken = Spoken(
            self.log.text(unplayed_s),
            cut=cut,
            first_audible_s=self._first_audible_s,
            synthesis_s=self.synthesis_s,
        )
        self._settled.set()
        self.token.detach()
