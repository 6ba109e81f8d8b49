"""The topics `presence` and `take_over`, and the interlock that follows from them."""

from collections import Counter
from dataclasses import replace

from rclpy.node import Node
from std_msgs.msg import String

from edgevox.agent.reasons import because
from edgevox.core.errors import InvalidValue
from edgevox.core.interlock import Holder, Interlock
from edgevox.core.log import get_logger
from edgevox.core.refusals import Refusal
from edgevox.core.status import ComponentName, HealthCheck, Status
from edgevox.ros2.bridge_status import Sharing
from edgevox.ros2.contract import PRESENCE, TAKE_OVER
from edgevox.ros2.presence.claim import Claim, ClaimMessage, new_claim, read_claim, write_claim
from edgevox.ros2.presence.members import MOST_OTHERS, Members
from edgevox.ros2.qos import profile
from edgevox.ros2.ticker import Ticker

log = get_logger(__name__)

NOT_IN_CHARGE = because("other_agent")


class Presence:
    """Says that this agent is here, hears who else is, and forbids motion if another is in charge.

    `robot` is the body's name, empty without one. What arrives is looked at on the executor's
    thread, and the beat is the ticker's, so that this agent is seen while a callback hangs.
    """

    name = ComponentName.PRESENCE
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, node: Node, robot: str, interlock: Interlock, ticker: Ticker) -> None:
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
        self._forget = ticker.every(1.0 / PRESENCE.rate_hz, self._beat)

    def close(self) -> None:
        """Say that this agent leaves, so that another need not wait until it is missed."""
        self._open = False
        self._forget()
        gone = ClaimMessage(replace(self._told.claim, leaving=True), in_charge=False)
        self._publisher.publish(String(data=write_claim(gone)))

    def status(self) -> Status:
        """Who shares the namespace, for people."""
        others = tuple(str(claim) for claim in self._here.values())
        claim = self._told.claim
        yields = bool(claim.robot) and not self._told.in_charge
        return Sharing(self._namespace, claim.id, others, yields).status()

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
        """Let follow what is known now, and say what has changed."""
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
