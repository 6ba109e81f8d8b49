"""Hearing with a server: it has the words, and what is on board hears stop words and steps in."""

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.servers.errors import LOOK_S, ServerFailed
from edgevox.core.servers.health import Breaker, ServerHealth
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.remote.hearing import HearingServer
from edgevox.voice.stt.speech_to_text import SpeechToText, Transcript, stop_first

log = get_logger(__name__)

STOP_S = 2.0
"""No longer sound is a stop word alone; a shorter one is also heard on board, at once."""
MOST_ONLY_BUSY = 2
"""So many answers without a sign of life before tell that a server shows none while it works."""
PATIENCE_S = 1.0
"""Seconds after which what is longer is also heard on board, in case the server does not answer."""


class SharedSpeechToText:
    """Implements `SpeechToText` by a server and, behind it, the model on board.

    A stop word that is heard on board counts at once, whatever the server does. If the server
    fails, the words on board count, and go on to count until it has answered a later utterance in
    the background: a server that is away keeps a person waiting only once. They also count where it
    shows no sign of life, so that one that hangs costs no more than two times `LOOK_S`. `is_stop`
    tells whether words stop the robot; `prompt_of` gives, by language, the sentences to expect.
    """

    def __init__(
        self,
        server: HearingServer,
        on_board: SpeechToText,
        *,
        prompt_of: Callable[[str], str] = lambda _: "",
        breaker: Breaker | None = None,
    ) -> None:
        self.is_stop: Callable[[str], bool] = lambda _: False
        self.health = ServerHealth("stt", server.address.host, "the model on board", breaker)
        self.on_board_fault = ""
        """The reason why nothing is heard on board; empty after a success."""
        self._server = server
        self._on_board = on_board
        self._prompt_of = prompt_of
        self._closing = CancelToken()
        self._only_busy = 0
        self._late: CancelToken | None = None
        self._trial: Future[Transcript] | None = None
        self._threads = ThreadPoolExecutor(5, "edgevox-shared-hearing")

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        """See `SpeechToText.transcribe`."""
        left = self._trial is not None and not self._trial.done()
        if (self.health.fault or left) and not self.on_board_fault:
            self._try_again(samples, language)
            self.health.fallbacks += 1
            return self._here(samples, language)
        token = self._closing.child()
        try:
            return self._raced(samples, language, token)
        finally:
            if token is not self._late:
                token.cancel("heard")
                token.detach()

    def warm_up(self, language: str) -> None:
        """Load what is on board; that it cannot be is no fault while the server hears."""
        try:
            self._here_first(language)
        except EdgeVoxError as error:
            log.warning("stt_on_board_missing", language=language, reason=str(error))

    def close(self) -> None:
        """See `SpeechToText.close`."""
        self._closing.cancel("closed")
        self._server.close()
        self._threads.shutdown()
        self._on_board.close()

    def _raced(self, samples: Samples, language: str, token: CancelToken) -> Transcript:
        there = self._threads.submit(self._there, samples, language, token)
        here: Future[Transcript] | None = None
        if samples.size <= STOP_S * RATE_HZ:
            here = self._threads.submit(self._here, samples, language)
            wait([here])  # a stop word counts, whatever the server makes of it
            if self._stops(here):
                return here.result()
        lives = self._lives(there, token)
        if lives and here is None:
            wait([there], PATIENCE_S)
        if there.done() or (lives and here is not None):
            return self._chosen(there, here, samples, language)
        here = here or self._threads.submit(self._here, samples, language)
        wait([there, here], return_when=FIRST_COMPLETED)
        if self._stops(here):
            return here.result()
        if not lives and not there.done() and not here.exception():
            self._trial, self._late = there, token  # what comes of it tells whether it is back
            there.add_done_callback(self._came_late)
            self.health.fallbacks += 1
            return here.result()
        return self._chosen(there, here, samples, language)

    def _came_late(self, there: "Future[Transcript]") -> None:
        """Note whether a server without a sign of life was only at work."""
        if self._late is not None:
            self._late.detach()
        self._only_busy += not there.cancelled() and there.exception() is None

    def _stops(self, here: "Future[Transcript]") -> bool:
        if not here.done() or here.exception():
            return False
        return self.is_stop(stop_first(here.result(), self.is_stop).text)

    def _lives(self, there: "Future[Transcript]", token: CancelToken) -> bool:
        """Whether the server has answered, or shows a sign of life while it does not."""
        wait([there], LOOK_S)
        if there.done() or self._only_busy >= MOST_ONLY_BUSY:
            return True
        look = self._threads.submit(self._server.lives, token)
        both: list[Future[Any]] = [there, look]
        wait(both, LOOK_S, return_when=FIRST_COMPLETED)
        return there.done() or (look.done() and look.result())

    def _chosen(
        self,
        there: "Future[Transcript]",
        here: "Future[Transcript] | None",
        samples: Samples,
        language: str,
    ) -> Transcript:
        """The server's words, else those on board."""
        try:
            return there.result()
        except ServerFailed:
            self.health.fallbacks += 1
            return here.result() if here else self._here(samples, language)

    def _there(self, samples: Samples, language: str, token: CancelToken) -> Transcript:
        try:
            said = self._server.transcribe(samples, language, self._prompt_of(language), token)
        except ServerFailed as error:
            self.health.fails(error)
            raise
        if not token.cancelled:
            self.health.works()
        return said

    def _try_again(self, samples: Samples, language: str) -> None:
        """Ask a server that failed last whether it is back, once it has rested."""
        if not self.health.resting and (self._trial is None or self._trial.done()):
            self._trial = self._threads.submit(self._there, samples, language, self._closing)

    def _here(self, samples: Samples, language: str) -> Transcript:
        try:
            said = self._on_board.transcribe(samples, language)
        except EdgeVoxError as error:
            self.on_board_fault = str(error)
            raise
        self.on_board_fault = ""
        return said

    def _here_first(self, language: str) -> None:
        try:
            self._on_board.warm_up(language)
        except EdgeVoxError as error:
            self.on_board_fault = str(error)
            raise
