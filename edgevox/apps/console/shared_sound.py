"""The ears and the mouth of an agent, for the pages of its console.

A page has a listener of its own, made like the room's. So the room's listener goes on hearing stop
words while pages are open, and speech in the room is not taken for speech into a held button. Both
share the speech-to-text engine.
"""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.agent.voice import endings, open_stop_detector, open_wakeword
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Heard, Way
from edgevox.core.events import SentenceReady
from edgevox.voice.listener import Listener
from edgevox.voice.sinks.tapped import Tap, TappedSink
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.vad import open_vad

SOURCE = "console"


class SharedSound:
    """A `ConsoleSound`: one client at a time speaks into `microphone`, all may hear `sink`."""

    def __init__(self, microphone: Pushed, sink: TappedSink, bus: Bus) -> None:
        self._microphone = microphone
        self._sink = sink
        self._lock = threading.Lock()
        self._client = ""
        self._held = False
        self._turn = 0
        self._forget = bus.subscribe(SentenceReady, self._said)

    def open(self, client: str, *, held: bool) -> bool:
        """See `ConsoleSound.open`."""
        with self._lock:
            if self._client not in ("", client):
                return False
            released = self._held and not held
            self._client, self._held = client, held
            if released:
                self._microphone.end()
            return True

    def close(self, client: str) -> None:
        """See `ConsoleSound.close`."""
        if self._release(client):
            self._microphone.end()

    def abandon(self, client: str) -> None:
        """See `ConsoleSound.abandon`."""
        if self._release(client):
            self._microphone.abandon()

    def push(self, client: str, samples: NDArray[np.int16]) -> None:
        """See `ConsoleSound.push`."""
        with self._lock:
            if client == self._client:
                self._microphone.push(samples, addressed=self._held)

    def listen(
        self, callback: Callable[[int, bytes], None], on_flush: Callable[[], None]
    ) -> Callable[[], None]:
        """See `ConsoleSound.listen`."""
        hear = Tap(lambda samples: callback(self._turn, samples.astype("<i2").tobytes()), on_flush)
        return self._sink.tap(hear)

    def shut(self) -> None:
        """Follow the conversation no longer."""
        self._forget()

    def _release(self, client: str) -> bool:
        with self._lock:
            if client != self._client:
                return False
            self._client, self._held = "", False
            return True

    def _said(self, sentence: SentenceReady) -> None:
        self._turn = sentence.turn


def share_sound(stack: ExitStack, parts: AgentParts) -> SharedSound | None:
    """Hear pages from now on; what must end is the stack's. None for an agent that only writes."""
    voice, settings, controls = parts.voice, parts.settings, parts.controls
    if voice is None:
        return None
    wakeword = open_wakeword(settings)
    if wakeword:
        stack.callback(wakeword.close)
    microphone = Pushed(SOURCE)
    listener = Listener(
        microphone,
        open_vad(),
        voice.stt,
        submit=lambda command: parts.command_router.submit(_of_console(command)),
        bus=parts.bus,
        language=lambda: controls.language,
        muted=lambda: controls.muted,
        audible=voice.sink.audible,
        wakeword=wakeword,
        is_stop=parts.conversation.is_stop,
        follow_up=parts.conversation.follow_ups,
        stop_detector=open_stop_detector(settings),
        ending=endings(parts.conversation).of,
        saying=voice.speech_output.saying,
    )
    stack.callback(listener.close)
    listener.start()
    sound = SharedSound(microphone, voice.sink, parts.bus)
    stack.callback(sound.shut)
    return sound


def _of_console(command: Command) -> Command:
    """Mark a command from an operator's microphone with the console's way, for the policy."""
    return replace(command, way=Way.CONSOLE_OPERATOR) if isinstance(command, Heard) else command
