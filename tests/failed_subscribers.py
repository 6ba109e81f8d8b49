"""What subscribers of a bus failed at: the bus logs it and goes on, a test must not."""

import logging

import edgevox.core.bus

EVENT = "subscriber_failed"
"""How the line begins that the bus writes then."""


class FailedSubscribers(logging.Handler):
    """Keeps what failed on any bus of this process, until it is taken."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self._lines: list[str] = []
        self.setFormatter(logging.Formatter())  # with the traceback

    def emit(self, record: logging.LogRecord) -> None:
        if str(record.msg).startswith(EVENT):
            self._lines.append(self.format(record))

    def take(self) -> str:
        """What failed since this was asked last, with the tracebacks; empty if nothing did."""
        taken, self._lines = self._lines, []
        return "\n".join(taken)


FAILED = FailedSubscribers()
logging.getLogger(edgevox.core.bus.__name__).addHandler(FAILED)


def assert_none_in(output: str) -> None:
    """Fails if a program's log holds a line of a subscriber that failed."""
    lines = [line for line in output.splitlines() if EVENT in line]
    assert not lines, f"a subscriber of the agent's bus failed: {lines}\n{output}"
