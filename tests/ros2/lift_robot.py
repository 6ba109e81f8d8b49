"""A lift as Open-RMF knows it: it says its state, and goes where lift_requests ask it to."""

from rmf_lift_msgs.msg import LiftRequest, LiftState
from stand_in import PAUSE_S, StandIn, main

FLOORS = ["L0", "L1", "L2", "L3"]
CLOSED, MOVING, OPEN = 0, 1, 2
STOPPED, UP, DOWN = 0, 1, 2
AGV_MODE = 2
STEPS = 4
"""So many moments it takes from floor to floor."""


class Lift(StandIn):
    """Obeys; it may hang (stay where it is) or lie (stand there with its door closed)."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.at, self.target, self.moments = 0, 0, 0
        self.session = ""
        self.states = self.create_publisher(LiftState, "lift_states", 10)
        self.hears(LiftRequest, "lift_requests", self.take)
        self.create_timer(PAUSE_S, self.move, self.group)

    def take(self, request: LiftRequest) -> None:
        self.session = request.session_id if request.request_type else ""
        if not request.request_type:
            self.target = self.at
        elif request.destination_floor in FLOORS and self.mode != "refuse":
            self.target = FLOORS.index(request.destination_floor)

    def move(self) -> None:
        if self.mode == "hang" or self.at == self.target:
            return
        self.moments += 1
        if self.moments % STEPS == 0:
            self.at += 1 if self.target > self.at else -1

    def say(self) -> None:
        moves = self.at != self.target
        self.states.publish(
            LiftState(
                lift_name="Lift1",
                available_floors=FLOORS,
                current_floor=FLOORS[self.at],
                destination_floor=FLOORS[self.target],
                door_state=CLOSED if moves or self.mode == "lie" else OPEN,
                motion_state=(UP if self.target > self.at else DOWN) if moves else STOPPED,
                current_mode=AGV_MODE,
                session_id=self.session,
            )
        )


if __name__ == "__main__":
    main(Lift, __doc__)
