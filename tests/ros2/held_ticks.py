"""Time that passes only as far as a test says, and the tickers that go by it.

What comes at a rate comes when the test lets that time pass, on the test's thread, however long
anything takes meanwhile.
"""

import math

from support.clock import HeldClock

from edgevox.ros2.ticker import TOGETHER_S, Ticker


class HeldTime(HeldClock):
    """With `ticker` it makes the tickers of a bridge, or of an `Interop`, that go by it."""

    def __init__(self) -> None:
        super().__init__()
        self._ticking: list[Ticker] = []

    def ticker(self, name: str) -> "HeldTicker":
        """One that ticks in `advance`, from its start on."""
        return HeldTicker(name, self)

    def take(self, ticker: Ticker) -> None:
        """This one was started; what is due then is done."""
        self._ticking.append(ticker)
        ticker.tick()

    def advance(self, seconds: float) -> None:
        """Let time pass, and do at each moment what is due then."""
        until_s = self.now_s + seconds
        while (wait_s := self._tick()) <= until_s - self.now_s + TOGETHER_S:
            self.now_s = min(self.now_s + wait_s, until_s)
        self.now_s = until_s

    def _tick(self) -> float:
        """Seconds until something is due again."""
        waits = [ticker.tick() for ticker in self._ticking]
        return min((wait_s for wait_s in waits if wait_s is not None), default=math.inf)


class HeldTicker(Ticker):
    """A ticker without a thread."""

    def __init__(self, name: str, time: HeldTime) -> None:
        super().__init__(name, time)
        self._time = time

    def start(self) -> None:
        self.begin()
        self._time.take(self)
