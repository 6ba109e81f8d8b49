"""What an agent says of itself on `presence`."""

import os
import secrets
import socket
import time
from dataclasses import asdict, dataclass
from typing import Annotated

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from edgevox.core.errors import InvalidValue
from edgevox.core.validation import dotted, explain
from edgevox.ros2.json_text import write

MOST_TERM = 2**31
MAX_BYTES = 4096
Name = Annotated[str, Field(max_length=255)]


@checked(frozen=True, config=ConfigDict(strict=True, extra="ignore"))
class Claim:
    """An agent, and how good its claim to move the robot is.

    `id` is its own for as long as it runs. `robot` is its body, empty if it has none and moves
    nothing. `term` is 0 just after its start, 1 once it was alone for a while, and one more than
    any other's when it is told to take over. `since_ns` is its start, by its machine's clock.
    """

    id: Annotated[str, Field(pattern="^[0-9a-f]{8}$")]
    robot: Name
    host: Name
    pid: int
    since_ns: int
    term: Annotated[int, Field(ge=0, le=MOST_TERM)] = 0
    leaving: bool = False

    @property
    def rank(self) -> tuple[int, int, str]:
        """The least of all is in charge: the highest term, then who was there first."""
        return (-self.term, self.since_ns, self.id)

    def __str__(self) -> str:
        return f"{self.robot or 'an agent without a robot'} (pid {self.pid} on {self.host})"


def new_claim(robot: str) -> Claim:
    """That of this process, which has just started."""
    host = socket.gethostname()[:255]
    return Claim(secrets.token_hex(4), robot[:255], host, os.getpid(), time.time_ns())


@dataclass(frozen=True, slots=True)
class ClaimMessage:
    """A claim as it goes over the wire."""

    claim: Claim
    in_charge: bool


_CLAIM = TypeAdapter(Claim)


def write_claim(told: ClaimMessage) -> str:
    """As JSON."""
    return write({**asdict(told.claim), "in_charge": told.in_charge})


def read_claim(text: str) -> Claim:
    """From JSON. Raises `InvalidValue`."""
    if len(text) > MAX_BYTES:
        raise InvalidValue("presence", f"{len(text)} characters", f"at most {MAX_BYTES}")
    try:
        return _CLAIM.validate_json(text)
    except ValidationError as error:
        raise explain(error, lambda place: dotted(("presence", *place))) from None
