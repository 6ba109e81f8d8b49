"""One robot of the benchmark `several`, a process of its own: its ears and its part in the group.

    python -m benchmarks.hearing.several_robot NAME

Each line on stdin is a `Round` as JSON. It hears the sound in real time, through the real listener;
what speech to text finds stands in the round, and so does how long that takes. It writes who is in
its group, and what it decided, each as a line of JSON.
"""

import json
import os
import signal
import sys
import threading
import time
from dataclasses import dataclass

import numpy as np

from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Heard
from edgevox.core.hearers import Hearers, UtteranceHeard
from edgevox.core.motion.interlock import Interlock
from edgevox.core.speech import Ending
from edgevox.ros2.node import RosNode
from edgevox.ros2.presence import Presence
from edgevox.ros2.ticker import Ticker
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, Samples
from edgevox.voice.listener import Listener
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.stt.speech_to_text import Transcript
from edgevox.voice.vad import open_vad

LOOK_EVERY_S = 0.05


@dataclass(frozen=True, slots=True)
class Round:
    """What a robot does in one round."""

    number: int
    sound: str
    """A file of numpy's with samples at 16 kHz."""
    start_s: float
    """The machine's monotonic time of its first sample."""
    words: str
    words_s: float
    """How long speech to text takes."""
    dies_s: float | None = None
    """It is killed so long after it claimed the utterance."""


class Robot:
    """Its node, its ears, and the words that stand in the round."""

    def __init__(self, name: str) -> None:
        self.node, self.ticker = RosNode(f"/{name.lower()}"), Ticker("ticker")
        self.hearers = Hearers(name, "hall")
        self.presence = Presence(self.node.node, "", Interlock(), self.ticker, self.hearers)
        self.round: Round | None = None
        self.claimed: UtteranceHeard | None = None
        self.source = Pushed("room")
        self.listener = Listener(
            self.source,
            open_vad(),
            self,
            submit=self.take,
            bus=Bus(),
            language=lambda: "en",
            muted=lambda: False,
            audible=lambda: 0.0,
            ending=lambda _: Ending.WHOLE,
            on_utterance=self._claims,
            echo="none",
        )
        self.names: tuple[str, ...] = ()
        self.ticker.every(LOOK_EVERY_S, self._look)

    def run(self) -> None:
        """Be that robot until stdin ends."""
        self.node.start()
        self.ticker.start()
        self.listener.start()
        tell(ready=True)
        for line in sys.stdin:
            self.hear(Round(**json.loads(line)))
        self.listener.close()
        self.presence.close()
        self.ticker.close()
        self.node.close()

    def hear(self, one: Round) -> None:
        """Push the sound of a round at its pace."""
        self.round, self.claimed = one, None
        samples = np.load(one.sound)
        for number, at in enumerate(range(0, samples.size - FRAME_SAMPLES, FRAME_SAMPLES)):
            time.sleep(max(0.0, one.start_s + (number + 1) * FRAME_S - time.monotonic()))
            self.source.push(samples[at : at + FRAME_SAMPLES])
        tell(number=one.number, over=True)

    def take(self, command: Command) -> None:
        """Take what the listener submits."""
        if isinstance(command, Heard) and (one := self.round):
            words_s = time.monotonic()

            def settled(other: str) -> None:
                tell(
                    number=one.number,
                    answers=other or "I",
                    words_s=words_s,
                    decided_s=time.monotonic(),
                    level_db=self.claimed.stands_out_db if self.claimed else None,
                )

            self.hearers.settle(command, settled)

    def transcribe(self, samples: Samples, language: str) -> Transcript:  # noqa: ARG002
        """Stand in for speech to text."""
        if self.round is None:
            return Transcript("")
        time.sleep(self.round.words_s)
        return Transcript(self.round.words)

    def warm_up(self, language: str) -> None:
        """Nothing to load."""

    def close(self) -> None:
        """Nothing to free."""

    def _claims(self, utterance: UtteranceHeard) -> None:
        self.hearers.heard(utterance)
        first, self.claimed = self.claimed is None, utterance
        if first and self.round:
            tell(number=self.round.number, claimed=True)
        if first and self.round and self.round.dies_s is not None:
            tell(number=self.round.number, dies_s=time.monotonic() + self.round.dies_s)
            threading.Timer(self.round.dies_s, os.kill, (os.getpid(), signal.SIGKILL)).start()

    def _look(self) -> None:
        if self.hearers.names != self.names:
            self.names = self.hearers.names
            tell(here=self.names)


_WRITING = threading.Lock()


def tell(**what: object) -> None:
    """Write a line of JSON."""
    with _WRITING:
        sys.stdout.write(json.dumps(what) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    Robot(sys.argv[1]).run()
