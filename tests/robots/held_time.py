"""Skills in a world whose time the test holds: `speed=0`, it passes only when the test says.

Whatever the machine does meanwhile, no time passes in the world: a test looks at a robot that
moves, interferes, and looks again, and the world is where it was. What waits for another thread
waits for an event; `HUNG_S` ends the test only where nothing would ever come.
"""

import threading
from collections.abc import Callable
from typing import Any, Self

from guards import HUNG_S

from edgevox.core.cancel import CancelToken

STEP_S = 0.02
"""The time that passes in one step of every body here."""


class HeldSkill:
    """A skill's method on a thread of its own, as a goal runs it. It has begun; no time passed."""

    def __init__(self, robot: Any, skill: Callable[..., Any], *arguments: object) -> None:
        self.reports: list[dict[str, Any]] = []
        self.result: Any = None
        self.error: BaseException | None = None
        self._robot = robot
        self._reported = threading.Condition()
        self._accepted = threading.Event()
        self.token = _Token(self._accepted)
        self._thread = threading.Thread(target=self._run, args=(skill, arguments))
        self._thread.start()
        assert self._accepted.wait(HUNG_S)

    def until(self, true: Callable[[], object]) -> Self:
        """Let time pass, a step at a time, until this is true while it runs."""
        while not true():
            assert self._moves, f"it ended before that was true: {self.error}"
            self._robot.advance(STEP_S)
        return self

    def end(self) -> BaseException | None:
        """Let time pass until it ends; what it raised, if anything."""
        while self._moves:
            self._robot.advance(STEP_S)
        return self.ended()

    def ended(self) -> BaseException | None:
        """What it raised, if anything. It ends without any more time: somebody saw to that."""
        self._thread.join(HUNG_S)
        assert not self._thread.is_alive(), "it goes on"
        return self.error

    def report(self) -> dict[str, Any]:
        """What it says next of its progress, while the world stands still."""
        with self._reported:
            known = len(self.reports)
            assert self._reported.wait_for(lambda: len(self.reports) > known, HUNG_S)
            return self.reports[-1]

    @property
    def _moves(self) -> bool:
        """Whether the body still has a goal: it knows before the skill's thread does."""
        return self._thread.is_alive() and self._robot.state()["goal"] is not None

    def _run(self, skill: Callable[..., Any], arguments: tuple[object, ...]) -> None:
        try:
            self.result = skill(*arguments, token=self.token, report=self._report)
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self.error = error
        finally:
            self._accepted.set()

    def _report(self, **feedback: Any) -> None:
        with self._reported:
            self.reports.append(feedback)
            self._reported.notify_all()


class _Token(CancelToken):
    """Tells when a skill begins to listen to it, which it does once it has the body."""

    def __init__(self, heard: threading.Event) -> None:
        super().__init__()
        self._heard = heard

    def on_cancel(self, callback: Callable[[], None]) -> Callable[[], None]:
        forget = super().on_cancel(callback)
        self._heard.set()
        return forget


def carry_out(robot: Any, skill: Callable[..., Any], *arguments: object) -> Any:
    """Call a skill's method and let time pass until its end; what it gives back or raises."""
    asked = HeldSkill(robot, skill, *arguments)
    error = asked.end()
    if error is not None:
        raise error
    return asked.result
