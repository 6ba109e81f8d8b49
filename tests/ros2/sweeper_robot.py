"""A robot that sweeps and mops by actions, and tells how much of it is done."""

from stand_in import StandIn, main
from sweeper_msgs.action import Sweep


class Sweeper(StandIn):
    """A number on ``do`` is the part that it has done since, 0 to 1; with 1 it is finished."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.part = 0.0
        for name in ("sweep", "mop"):
            self.acts(Sweep, name, self.work, lambda: Sweep.Result(area=12.5))

    def work(self, goal) -> bool:
        while self.part != 1.0:
            if goal.is_cancel_requested or not self.pause():
                return False
            percent = min(max(round(100 * self.part), 0), 255)
            goal.publish_feedback(Sweep.Feedback(part=self.part, percent=percent))
        return True

    def change(self, change: str) -> bool:
        try:
            self.part = float(change)
        except ValueError:
            return False
        return True


if __name__ == "__main__":
    main(Sweeper, __doc__)
