"""What the console is given: the robot as it may be seen, steered, heard and stopped."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Submit
from edgevox.core.controls import Controls
from edgevox.core.motion.interlock import Interlock
from edgevox.core.motion.software_stop import SoftwareStop
from edgevox.core.reason import Reason
from edgevox.core.ways import Way


class ConsoleRobot(Protocol):
    """A body as the page sees and steers it."""

    def scene(self) -> Mapping[str, Any]:
        """What does not move, JSON-ready; another ``version`` whenever it is another."""

    def live(self) -> Mapping[str, Any]:
        """What moves, JSON-ready. On a worker thread, 15 times a second while somebody looks."""

    def picture(self) -> bytes | None:
        """A JPEG of camera or view, None if there is none now. May take long: a worker thread."""

    def drive(self, linear_m_s: float, angular_rad_s: float, mark: int | None = None) -> None:
        """Steer it, by policy, as an operator. Raises `EdgeVoxError`. Never waits.

        `mark` is the interlock's when it was asked for. After a stop it raises `StreamStopped`
        until whoever drives has let go.
        """

    def let_go(self) -> None:
        """Whoever drove has let go of the stick: what comes next begins anew."""

    def halt(self) -> None:
        """End what `drive` began, with one zero. Never waits, never is forbidden."""


class ConsoleSound(Protocol):
    """The ears and the mouth of the robot; samples are 16 bit, 16 kHz, mono."""

    def open(self, client: str, *, held: bool) -> bool:
        """Take it that a client speaks from now on; False while another does.

        While the button is `held` it is to the robot, and needs no wake word.
        """

    def close(self, client: str) -> None:
        """A client has ended what it says, and speaks no more."""

    def abandon(self, client: str) -> None:
        """A client is gone: what it was saying does not count."""

    def push(self, client: str, samples: NDArray[np.int16]) -> None:
        """One frame of 20 ms from the client who speaks."""

    def listen(
        self, callback: Callable[[int, bytes], None], on_flush: Callable[[], None]
    ) -> Callable[[], None]:
        """Hear what the robot says: turn and samples. `on_flush` when it is cut short.

        Both are called on any thread. Returns a way to forget them.
        """


class ConsoleRecorder(Protocol):
    """Recordings that somebody starts, ends and takes home. On a worker thread: they may wait."""

    @property
    def running(self) -> bool:
        """Whether it records now."""

    def listen(self, listener: Callable[[bool], None]) -> Callable[[], object]:
        """Call it, on any thread, with `running` when that changes. Returns what ends that."""

    def start(self) -> None:
        """Begin a recording. Raises `EdgeVoxError`."""

    def stop(self) -> None:
        """End it. Raises `EdgeVoxError`."""

    def files(self) -> Sequence[Path]:
        """What may be downloaded, each by its file's name."""

    def delete(self, name: str) -> None:
        """Remove the recording with a file of this name. Raises `EdgeVoxError`."""


@dataclass(frozen=True)
class ConsoleContext:
    """The robot, as much of it as the console needs.

    `submit` raises `InvalidValue`. `answer` gives a yes or a no to what was asked. `go_to` and
    `name_place` make the command for a point of the map frame, in metres; None where the robot
    cannot. `describe` gives by language what a page is told once, `status` what it is told once a
    second while somebody looks. `follow_log` calls with each line of the log that belongs to a turn
    and may be told, on any thread, and returns what ends that. `stops` says of a command whether it
    stops the robot. `explain` says in a language why
    something was not done, of a `Reason` or of what was raised; empty where it has no sentence.
    """

    name: str
    bus: Bus
    interlock: Interlock
    submit: Submit
    controls: Controls
    safety: SoftwareStop
    describe: Callable[[str], Mapping[str, Any]]
    status: Callable[[], Mapping[str, Any]]
    robot: ConsoleRobot | None = None
    sound: ConsoleSound | None = None
    recorder: ConsoleRecorder | None = None
    answer: Callable[[bool, Way, int], None] | None = None
    go_to: Callable[[float, float], Command] | None = None
    name_place: Callable[[str, float, float], Command] | None = None
    explain: Callable[[Reason | Exception, str], str] = lambda _why, _language: ""
    stops: Callable[[Command], bool] = lambda _command: False
    follow_log: Callable[[Callable[[Mapping[str, Any]], None]], Callable[[], object]] | None = None
