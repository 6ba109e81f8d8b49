"""The agents that share a namespace, and the robots that hear the same person.

Two agents on one namespace hear the same sentences and have nodes of the same name; without a rule
both would drive. Each agent publishes a `Claim`; `Members` lists the agents present and holds the
rule; `Presence` serves the topics `presence` and `take_over`, and the interlock that follows from
them. No clocks are compared, and the graph is not used: it shows a killed process for another 20 s.

Every process that hears the same claims gives the same answer: the agents present, and the one in
charge. The rule: the agent that was told to take over last, else the one that has been here alone,
else the one that started first. So the later one waits, and the clocks of two machines need not
agree, unless both start within seconds of each other; then one of them is in charge all the same,
and only one.

Time is counted in an agent's own messages that came back over the wire, once a second: an agent
that is frozen, or whose executor is held up, counts nothing, and takes no other agent for gone.

With a group, `Presence` also carries the claims of `edgevox.core.hearers` between robots, each of
which has a namespace of its own.
"""

import os
import secrets
import socket
import time
from collections import Counter
from dataclasses import asdict, dataclass, replace
from typing import Annotated

from pydantic import ConfigDict, Field, TypeAdapter
from pydantic.dataclasses import dataclass as checked
from rclpy.node import Node
from std_msgs.msg import String

from edgevox.agent.text.reasons import because
from edgevox.core.errors import InvalidValue, Refusal
from edgevox.core.files.validation import read_message
from edgevox.core.hearers import BEAT_S, MOST_ROBOTS, MOST_UTTERANCES, Hearers
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Holder, Interlock
from edgevox.core.status import ComponentName, HealthCheck, Status
from edgevox.ros2.contract import HEARERS, PRESENCE, TAKE_OVER, write
from edgevox.ros2.messages import profile
from edgevox.ros2.open import Sharing
from edgevox.ros2.ticker import Ticker

log = get_logger(__name__)

MOST_TERM = 2**31
MAX_BYTES = 4096
Name = Annotated[str, Field(max_length=255)]


@checked(frozen=True, config=ConfigDict(strict=True, extra="ignore"))
class Claim:
    """An agent's claim to move the robot."""

    id: Annotated[str, Field(pattern="^[0-9a-f]{8}$")]
    """The agent's own, for as long as it runs."""
    robot: Name
    """The name of its body; empty if it has none, and moves nothing."""
    host: Name
    pid: int
    since_ns: int
    """The agent's start, by its machine's clock, in nanoseconds of Unix time."""
    term: Annotated[int, Field(ge=0, le=MOST_TERM)] = 0
    """0 after the start, 1 once the agent was alone for a while, and one more than any other's
    when the agent is told to take over."""
    leaving: bool = False

    @property
    def rank(self) -> tuple[int, int, str]:
        """The sort key; the least is in charge: the highest term, then the earliest start."""
        return (-self.term, self.since_ns, self.id)

    def __str__(self) -> str:
        return f"{self.robot or 'an agent without a robot'} (pid {self.pid} on {self.host})"


def new_claim(robot: str) -> Claim:
    """Return the claim of this process, which has just started."""
    host = socket.gethostname()[:255]
    return Claim(secrets.token_hex(4), robot[:255], host, os.getpid(), time.time_ns())


@dataclass(frozen=True, slots=True)
class ClaimMessage:
    """A claim as it goes over the wire."""

    claim: Claim
    in_charge: bool


_CLAIM = TypeAdapter(Claim)


def write_claim(told: ClaimMessage) -> str:
    """Write a claim as JSON."""
    return write({**asdict(told.claim), "in_charge": told.in_charge})


def read_claim(text: str) -> Claim:
    """Read a claim from JSON. Raises `InvalidValue`."""
    return read_message(_CLAIM, text, "presence", MAX_BYTES)


GONE_BEATS = 4
"""An agent is gone after so many beats of this one without a message."""
SETTLED_BEATS = 5
"""Beats alone after which an agent counts as first: discovery takes 3 s at most."""
MOST_OTHERS = 32


class Members:
    """The claims of all agents of a namespace. Not thread-safe."""

    def __init__(self, me: Claim) -> None:
        self.me = me
        self._others: dict[str, Claim] = {}
        self._missed: dict[str, int] = {}
        self._alone_beats = 0

    @property
    def others(self) -> tuple[Claim, ...]:
        """The other agents' claims, the best first."""
        return tuple(sorted(self._others.values(), key=lambda claim: claim.rank))

    @property
    def charge(self) -> Claim | None:
        """The claim of the agent that moves the robot; None if no agent has a robot."""
        able = [claim for claim in (self.me, *self.others) if claim.robot]
        return min(able, key=lambda claim: claim.rank, default=None)

    @property
    def in_charge(self) -> bool:
        """Whether this agent is in charge."""
        return self.charge == self.me

    def hear(self, claim: Claim) -> None:
        """Take what another agent says of itself."""
        if claim.leaving:
            self._forget(claim.id)
        elif claim.id in self._others or len(self._others) < MOST_OTHERS:
            self._others[claim.id] = claim
            self._missed[claim.id] = 0
            self._alone_beats = 0

    def give(self, agent_id: str) -> bool:
        """Put this agent in charge, if it is this one; whether it is. Raises `InvalidValue`."""
        if agent_id != self.me.id:
            if agent_id not in self._others:
                known = (self.me.id, *self._others)
                raise InvalidValue("take_over", agent_id, f"one of {', '.join(known)}")
            return False
        if not self.me.robot:
            raise InvalidValue("take_over", agent_id, "an agent that has a robot")
        if not self.in_charge:
            highest = max(claim.term for claim in self.others)
            self.me = replace(self.me, term=min(highest + 1, MOST_TERM))
        return True

    def beat(self) -> None:
        """Another second has passed in which this agent listened."""
        for agent_id in list(self._others):
            self._missed[agent_id] += 1
            if self._missed[agent_id] >= GONE_BEATS:
                self._forget(agent_id)
        if not self._others:
            self._alone_beats += 1
        if self._alone_beats >= SETTLED_BEATS and not self.me.term:
            self.me = replace(self.me, term=1)

    def _forget(self, agent_id: str) -> None:
        self._others.pop(agent_id, None)
        self._missed.pop(agent_id, None)


NOT_IN_CHARGE = because("other_agent")


class Presence:
    """Publishes this agent's presence, hears the others, and yields to one in charge.

    While another agent is in charge, the interlock forbids motion. `robot` is the body's name,
    empty without one. `hearers` are the robots of its group, None without one. Messages are handled
    on the executor's thread; the beat is the ticker's, so that this agent is seen even while a
    callback hangs.
    """

    name = ComponentName.PRESENCE
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self,
        node: Node,
        robot: str,
        interlock: Interlock,
        ticker: Ticker,
        hearers: Hearers | None = None,
    ) -> None:
        self._namespace = node.get_namespace()
        self._take_over = node.resolve_topic_name(TAKE_OVER.topic)
        self._interlock = interlock
        self._roll = Members(new_claim(robot))
        self._here: dict[str, Claim] = {}
        self._beat_due = False
        self._open = True
        self._told = self._standing()
        self.refusals: Counter[tuple[str, ...]] = Counter(
            {(topic, Refusal.INVALID): 0 for topic in (PRESENCE.topic, TAKE_OVER.topic)}
        )
        self._publisher = node.create_publisher(String, PRESENCE.topic, profile(PRESENCE.qos))
        of_all = profile(PRESENCE.qos)
        of_all.depth = MOST_OTHERS
        node.create_subscription(String, PRESENCE.topic, self._hear, of_all)
        node.create_subscription(String, TAKE_OVER.topic, self._give, profile(TAKE_OVER.qos))
        self._forget = [ticker.every(1.0 / PRESENCE.rate_hz, self._beat)]
        self._hearers = self._join(node, hearers, ticker) if hearers else None

    def _join(self, node: Node, hearers: Hearers, ticker: Ticker) -> Hearers | None:
        """Join the group; without the right to, this robot answers whatever it hears."""
        of_all = profile(HEARERS.qos)
        of_all.depth = MOST_ROBOTS * MOST_UTTERANCES
        try:
            claims = node.create_publisher(String, HEARERS.topic, of_all)
            node.create_subscription(String, HEARERS.topic, self._hear_claim, of_all)
        except RuntimeError as error:  # an enclave of an older EdgeVox has no right to
            log.error("group_unheard", group=hearers.group, reason=str(error))  # noqa: TRY400
            return None
        for reason in (Refusal.INVALID, Refusal.TOO_MANY):
            self.refusals[HEARERS.topic, reason] = 0
        hearers.send = lambda text: claims.publish(String(data=text))
        self._forget.append(ticker.every(BEAT_S, hearers.beat))
        return hearers

    def _hear_claim(self, message: String) -> None:
        if self._open and self._hearers:
            try:
                self._hearers.hear(message.data)
            except InvalidValue as error:
                self._refuse(HEARERS.topic, error)
            self.refusals[HEARERS.topic, Refusal.TOO_MANY] = self._hearers.dropped

    def close(self) -> None:
        """Say that this agent leaves, so that another need not wait until it is missed."""
        self._open = False
        for forget in self._forget:
            forget()
        if self._hearers:
            self._hearers.leave()
        gone = ClaimMessage(replace(self._told.claim, leaving=True), in_charge=False)
        self._publisher.publish(String(data=write_claim(gone)))

    def status(self) -> Status:
        """Return the status of the shared namespace, for people."""
        others = tuple(str(claim) for claim in self._here.values())
        claim = self._told.claim
        yields = bool(claim.robot) and not self._told.in_charge
        group = None if self._hearers is None else self._hearers.names
        return Sharing(self._namespace, claim.id, others, yields, group).status()

    def _beat(self) -> None:
        self._beat_due = True
        self._say()

    def _say(self) -> None:
        self._publisher.publish(String(data=write_claim(self._told)))

    def _hear(self, message: String) -> None:
        if not self._open:
            return
        try:
            claim = read_claim(message.data)
        except InvalidValue as error:
            self._refuse(PRESENCE.topic, error)
            return
        if claim.id != self._roll.me.id:
            self._roll.hear(claim)
        elif self._beat_due:
            self._beat_due = False
            self._roll.beat()
        self._settle()

    def _give(self, message: String) -> None:
        if not self._open:
            return
        try:
            self._roll.give(message.data.strip())
        except InvalidValue as error:
            self._refuse(TAKE_OVER.topic, error)
            return
        self._settle()

    def _refuse(self, topic: str, error: InvalidValue) -> None:
        self.refusals[topic, error.reason] += 1
        log.warning("message_refused", topic=topic, reason=str(error))

    def _standing(self) -> ClaimMessage:
        return ClaimMessage(self._roll.me, self._roll.in_charge)

    def _settle(self) -> None:
        """Apply the present claims, and report the changes."""
        before, self._told = self._told, self._standing()
        was_here, self._here = self._here, {claim.id: claim for claim in self._roll.others}
        self._obey()
        for agent_id in self._here.keys() - was_here.keys():
            self._tell_of(self._here[agent_id])
        for agent_id in was_here.keys() - self._here.keys():
            gone = str(was_here[agent_id])
            log.warning("other_agent_gone", other=gone, in_charge=self._told.in_charge)
        if before.in_charge != self._told.in_charge:
            log.warning("charge_changed", in_charge=self._told.in_charge)
        if before != self._told or self._here.keys() - was_here.keys():
            self._say()  # whoever is new, or has waited for this, need not wait for the next beat

    def _obey(self) -> None:
        if self._told.claim.robot and not self._told.in_charge:
            self._interlock.engage(Holder.PRESENCE, NOT_IN_CHARGE)
        else:
            self._interlock.release(Holder.PRESENCE)

    def _tell_of(self, other: Claim) -> None:
        log.warning(
            "other_agent_here",
            other=str(other),
            namespace=self._namespace,
            in_charge=self._told.in_charge,
            take_over=f"ros2 topic pub --once -w 2 {self._take_over} std_msgs/msg/String"
            f" \"data: '{self._roll.me.id}'\"",
        )
