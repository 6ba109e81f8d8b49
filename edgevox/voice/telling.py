"""Handing on what was heard to whoever may break."""

from collections.abc import Callable

from edgevox.core.commands import Command
from edgevox.core.log import get_logger

log = get_logger(__name__)


class Telling:
    """Submits commands: whoever breaks on one is counted and logged, and gets what follows."""

    def __init__(self, submit: Callable[[Command], None]) -> None:
        self._submit = submit
        self.failed = 0

    def __call__(self, command: Command) -> None:
        try:
            self._submit(command)
        except Exception:
            self.failed += 1
            log.exception("command_untaken", command=type(command).__name__)
