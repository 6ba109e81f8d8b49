"""A quadruped with Unitree's sport interface: requests and responses on two topics.

Its remote control asks, too: each answer is followed at once by one that is for the remote.
"""

from stand_in import StandIn, main
from unitree_api.msg import Request, Response

STOP_MOVE, DANCE, GET_STATE = 1003, 1022, 1034
GRANTED, REFUSED = 0, 3203


class Quadruped(StandIn):
    """Answers each request; it may refuse, or hang. A dance lasts until it is stopped or let be."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.dancing = False
        self.responses = self.create_publisher(Response, "api/sport/response", 10)
        self.hears(Request, "api/sport/request", self.take)

    def take(self, request: Request) -> None:
        number = request.header.identity.api_id
        if number == STOP_MOVE:
            self.dancing = False
        if number == DANCE and self.mode == "obey":
            self.dancing = True
            while self.dancing and self.pause():
                pass
        if self.mode == "hang":
            return
        response = Response()
        response.header.identity = request.header.identity
        response.header.status.code = REFUSED if self.mode == "refuse" else GRANTED
        self.responses.publish(response)
        response.header.identity.api_id = GET_STATE
        self.responses.publish(response)

    def change(self, change: str) -> bool:
        self.dancing = self.dancing and change != "rest"
        return change == "rest"


if __name__ == "__main__":
    main(Quadruped, __doc__)
