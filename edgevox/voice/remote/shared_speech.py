"""Speech with a server: its voice is the first to be tried, and those on board follow."""

import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing

from edgevox.core.cancel import CancelToken
from edgevox.core.languages import Voice
from edgevox.core.servers.errors import LOOK_S, ServerFailed, Unreachable
from edgevox.core.servers.health import Breaker, ServerHealth
from edgevox.voice.audio import Chunk
from edgevox.voice.remote.speaking import NoVoice, SpeakingServer
from edgevox.voice.tts.synthesiser import Synthesiser
from edgevox.voice.tts.voices import SERVER, VoiceChoice

_USUAL_HZ = 22_050
"""The rate until the server has spoken."""


class SharedSpeech:
    """The voice of a server, beside those on board. Used from one thread, but for `health`.

    `voices` gives the voices on board that are to be used now. They speak while the server fails,
    and until it has spoken a later phrase in the background, unheard. A server that shows no sign
    of life has failed after two times `LOOK_S`.
    """

    def __init__(
        self,
        server: SpeakingServer,
        voices: Callable[[], Sequence[VoiceChoice]],
        language: Callable[[], str],
        *,
        breaker: Breaker | None = None,
    ) -> None:
        self.health = ServerHealth("tts", server.address.host, "the voice on board", breaker)
        self._server = server
        self._voices = voices
        self._language = language
        self._unspoken: set[str] = set()
        self._shows_life = True
        self._closing = CancelToken()
        self._threads = ThreadPoolExecutor(2, "edgevox-shared-speech")
        self._trial: Future[None] | None = None

    def __call__(self) -> Sequence[VoiceChoice]:
        """The server's voice, unless it has none for the language, then those on board."""
        language, on_board = self._language(), self._voices()
        if language in self._unspoken:
            return on_board
        return (VoiceChoice(language, Voice(self.health.server, SERVER, "")), *on_board)

    def open(self, choice: VoiceChoice) -> Synthesiser:
        """The server's voice for the language of this choice."""
        return _ServerVoice(self, choice.language)

    def close(self) -> None:
        """End what is being asked."""
        self._closing.cancel("closed")
        self._server.close()
        self._threads.shutdown()

    def speak(self, text: str, language: str, token: CancelToken) -> Iterator[Chunk]:
        """A phrase in the server's voice. Raises `ServerFailed`, at once if it failed last."""
        if self.health.fault:
            self._try_again(text, language)
            self.health.fallbacks += 1
            raise Unreachable(f"{self.health.server} has not answered again yet")
        heard, asked = threading.Event(), token.child()
        look = self._threads.submit(self._look_for_life, heard, asked)
        try:
            for chunk in self._server.speak(text, language, asked):
                if not heard.is_set():
                    heard.set()
                    self.health.works()
                yield chunk
            if asked.cancelled and not token.cancelled:
                raise Unreachable("no sign of life")
        except ServerFailed as error:
            self._failed(error)
            self.health.fallbacks += 1
            raise
        finally:
            heard.set()
            look.cancel()
            asked.detach()

    def _look_for_life(self, heard: threading.Event, asked: CancelToken) -> None:
        """Give up a phrase that is not heard soon, by a server that shows no sign of life."""
        if (
            heard.wait(LOOK_S)
            or not self._shows_life
            or self._server.lives(asked)
            or heard.is_set()
        ):
            return
        asked.cancel("no sign of life")

    def look(self, language: str) -> None:
        """Ask what the server has; a failure is noted."""
        if self.health.fault:
            return
        try:
            self._server.look(language, self._closing)
        except ServerFailed as error:
            self._failed(error)

    def _try_again(self, text: str, language: str) -> None:
        """Ask a server that failed last whether it is back, once it has rested."""
        if not self.health.resting and (self._trial is None or self._trial.done()):
            self._trial = self._threads.submit(self._unheard, text, language)

    def _unheard(self, text: str, language: str) -> None:
        look = self._threads.submit(self._server.lives, self._closing)
        with closing(self._server.speak(text, language, self._closing)) as chunks:
            try:
                if next(chunks, None) is not None:
                    self._shows_life = look.result()  # some show none while they speak
                    self.health.works()
            except ServerFailed as error:
                self._failed(error)

    def _failed(self, error: ServerFailed) -> None:
        if isinstance(error, NoVoice):
            self._unspoken.add(error.language)
        self.health.fails(error)


class _ServerVoice:
    """Implements `Synthesiser` by a server."""

    phrase_chars = 160

    def __init__(self, shared: SharedSpeech, language: str) -> None:
        self.sample_rate_hz = _USUAL_HZ
        self._shared = shared
        self._language = language

    def warm_up(self) -> None:
        self._shared.look(self._language)

    def synthesise(self, sentence: str, token: CancelToken) -> Iterator[Chunk]:
        for chunk in self._shared.speak(sentence, self._language, token):
            self.sample_rate_hz = chunk.rate_hz
            yield chunk
