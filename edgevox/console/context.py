"""The console's view of the robot: how pages may see, steer, hear and stop it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Submit, Way
from edgevox.core.controls import Controls
from edgevox.core.motion.interlock import Interlock
from edgevox.core.motion.software_stop import SoftwareStop
from edgevox.core.reason import Reason


class ConsoleRobot(Protocol):
    """A body as the page sees and steers it."""

    def scene(self) -> Mapping[str, Any]:
        """Return the fixed parts, JSON-ready, with a new ``version`` for every change."""

    def live(self) -> Mapping[str, Any]:
        """Return the moving parts, JSON-ready.

        Called on a worker thread, 15 times a second while pages look.
        """

    def picture(self) -> bytes | None:
        """A JPEG of camera or view, None if there is none now. May take long: a worker thread."""

    def drive(self, linear_m_s: float, angular_rad_s: float, mark: int | None = None) -> None:
        """Steer it, by policy, as an operator. Raises `EdgeVoxError`. Never waits.

        `mark` is the interlock's when it was asked for. After a stop it raises `StreamStopped`
        until whoever drives has let go.
        """

    def let_go(self) -> None:
        """Note that the driver has let go of the stick: the next velocity starts a new stream."""

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
        """Take a frame of 20 ms from the client who speaks."""

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
        """Return the files that may be downloaded, by file name."""

    def delete(self, name: str) -> None:
        """Remove the recording with a file of this name. Raises `EdgeVoxError`."""


@dataclass(frozen=True)
class ConsoleContext:
    """The robot, as much of it as the console needs."""

    name: str
    bus: Bus
    interlock: Interlock
    submit: Submit
    """Sends a command; raises `InvalidValue`."""
    controls: Controls
    safety: SoftwareStop
    describe: Callable[[str], Mapping[str, Any]]
    """Returns, by language, the message that a page gets once."""
    status: Callable[[], Mapping[str, Any]]
    """Returns the message that a page gets once a second while it looks."""
    robot: ConsoleRobot | None = None
    sound: ConsoleSound | None = None
    recorder: ConsoleRecorder | None = None
    answer: Callable[[bool, Way, int], None] | None = None
    """Answers a question of the robot with yes or no."""
    go_to: Callable[[float, float], Command] | None = None
    """Makes the command for a point of the map frame, in metres; None if the robot cannot."""
    name_place: Callable[[str, float, float], Command] | None = None
    """Makes the command that names a point of the map frame, in metres; None if the robot
    cannot."""
    explain: Callable[[Reason | Exception, str], str] = lambda _why, _language: ""
    """Returns the reason of a failure in a language; empty without a sentence for it."""
    stops: Callable[[Command], bool] = lambda _command: False
    """Whether a command stops the robot."""
    follow_log: Callable[[Callable[[Mapping[str, Any]], None]], Callable[[], object]] | None = None
    """Calls its argument with each line of the log that belongs to a turn and may be shown, on
    any thread; returns a function that ends that."""
