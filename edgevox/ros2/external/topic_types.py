"""The types of the robot's topics, asked of the graph: the robot decides, and EdgeVox follows.

Robots of one kind use different types on one topic: velocities are Twist or TwistStamped, pictures
are raw or compressed. Each of EdgeVox's ends takes the type of the robot's newest end that it
knows, and changes when a driver restarts with another. The middleware allows a node one type on a
topic, so an end closes before it opens with another type.

Velocities leave in every type that is there: a stop must reach the robot whichever of them is its
own, so an end opens beside the first, in a node of its own, and the first stays until its type is
gone.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.ros2.clients import type_name
from edgevox.ros2.contract_rows import QosSpec
from edgevox.ros2.messages import as_on_the_graph, profile, unheard
from edgevox.ros2.standard_topics import DRIVEN

log = get_logger(__name__)

Close = Callable[[], object]
Open = Callable[[], Close]
"""Opens EdgeVox's end with one type; returns what closes it."""
MOST_NAMED = 3


@dataclass(frozen=True, slots=True)
class UnfitTopic:
    """A topic on which the robot has only types that EdgeVox does not know there."""

    topic: str
    """Its full name."""
    types: tuple[str, ...]
    expected: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.topic} has the type {_either(self.types)}, and not {_either(self.expected)}"

    @property
    def reason(self) -> Reason:
        """The reason why it cannot be used."""
        there, expected = _either(map(_short, self.types)), _either(map(_short, self.expected))
        return because("wrong_type", str(self), topic=self.topic, type=there, expected=expected)

    def check(self) -> None:
        """Raise `SkillFailed`."""
        raise SkillFailed(self.reason)


@dataclass
class _End:
    """EdgeVox's end of a topic."""

    topic: str
    """Its full name."""
    ends_there: Callable[[str], Sequence[Any]]
    """Lists the robot's ends of it."""
    ways: Mapping[str, Open]
    """How to open it, by type, the usual one first."""
    type: str
    close: Close
    ways_beside: Mapping[str, Open]
    """How to open another beside it, by type; empty where the newest type alone is used."""
    apart: Callable[[QoSProfile], str]
    """Why an end of the robot with this quality of service and EdgeVox's get nothing through."""
    beside: dict[str, Close] = field(default_factory=dict)
    seen: dict[bytes, int] = field(default_factory=dict)
    """When each of the robot's ends was first seen, in looks."""
    types: tuple[str, ...] = ()
    """All types that are there."""
    unfit: UnfitTopic | None = None
    barrier: str = ""
    """Why nothing gets through, by the quality of service; empty where something does."""

    @property
    def doubt(self) -> str:
        """What is not as it should be, in a few words; empty without anything."""
        if self.unfit:
            return str(self.unfit)
        if self.barrier:
            return f"nothing gets through on {self.topic}: {self.barrier}"
        return f"{self.topic} has the types {' and '.join(self.types)}" if self.types[1:] else ""


class TopicTypes:
    """Opens and changes EdgeVox's ends. Call `look` and `follow` from one thread, or with a lock.

    `unfit` and the other reading methods may be called from any thread.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._ends: dict[str, _End] = {}
        self._looks = 0

    def follow(
        self,
        topic: str,
        ways: Mapping[str, Open],
        beside: Mapping[str, Open] | None = None,
        *,
        least: QosSpec | None = None,
    ) -> None:
        """Open an end of a topic of the contract, with the usual type until the robot is seen.

        `ways` has a way for every type of the topic's row, and `beside` one to open it beside the
        first where all types that are there are to be used. `least` is the lowest quality of
        service that is opened, if that is another than the row's.
        """
        row, node = DRIVEN[topic], self._node
        usual, ours = row.type, as_on_the_graph(profile(least or row.qos))
        into = row.direction == "in"
        there = node.get_publishers_info_by_topic if into else node.get_subscriptions_info_by_topic
        self._ends[topic] = _End(
            node.resolve_topic_name(topic),
            there,
            {one: ways[one] for one in row.types},
            usual,
            ways[usual](),
            beside or {},
            lambda theirs: unheard(theirs, ours) if into else unheard(ours, theirs),
        )

    def look(self) -> None:
        """Look at the graph, and change the ends whose topic has another type there."""
        self._looks += 1
        for end in self._ends.values():
            self._look_at(end)

    def unfit(self, topic: str) -> UnfitTopic | None:
        """What the robot has there in place of a type that fits; None if it fits or is not seen."""
        return self._ends[topic].unfit

    @property
    def doubts(self) -> list[str]:
        """What is not as it should be, in a few words a topic."""
        return [end.doubt for end in self._ends.values() if end.doubt]

    def is_there(self, topic: str) -> bool:
        """Return whether the robot has an end of it now that something gets through to."""
        end = self._ends[topic]
        return any(not end.apart(one.qos_profile) for one in end.ends_there(end.topic))

    def barrier(self, topic: str) -> str:
        """Why nothing gets through to the robot's ends, by their quality of service; or empty."""
        return self._ends[topic].barrier

    def close(self) -> None:
        """Close what is open beside the first ends; those are their node's."""
        for end in self._ends.values():
            while end.beside:
                end.beside.popitem()[1]()

    def elsewhere(self, topic: str) -> tuple[str, ...]:
        """Other topics on which the robot may have what is missing on this one, by their types."""
        end = self._ends[topic]
        return tuple(
            f"{name} ({types[0]})"
            for name, types in sorted(self._node.get_topic_names_and_types())
            if name != end.topic and end.ways.keys() & set(types) and end.ends_there(name)
        )[:MOST_NAMED]

    def _look_at(self, end: _End) -> None:
        infos = end.ends_there(end.topic)
        there = {bytes(one.endpoint_gid): one.topic_type for one in infos}
        end.seen = {gid: end.seen.get(gid, self._looks) for gid in there}
        fit = [gid for gid in there if there[gid] in end.ways]
        barriers = [end.apart(one.qos_profile) for one in infos if one.topic_type in end.ways]
        barrier = barriers[0] if barriers and all(barriers) else ""
        types = tuple(sorted(set(there.values())))
        self._judge(end, types, barrier, fits=bool(fit) or not there)
        if not fit:
            return
        order = list(end.ways)
        newest = max(fit, key=lambda gid: (end.seen[gid], order.index(there[gid])))
        if end.ways_beside:
            self._use_all(end, {there[gid] for gid in fit}, there[newest])
        elif there[newest] != end.type:
            self._change(end, there[newest])

    def _use_all(self, end: _End, types: Collection[str], newest: str) -> None:
        """Use all of these types; what changes is open beside until the next look."""
        others = {one for one in types if one != end.type}
        for gone in end.beside.keys() - others:
            end.beside.pop(gone)()
        if end.type not in types:
            self._change(end, newest)
            return
        for new in others - end.beside.keys():
            end.beside[new] = end.ways_beside[new]()

    def _change(self, end: _End, type_: str) -> None:
        log.info("topic_type_changed", topic=end.topic, type=type_, before=end.type)
        end.close()
        end.type, end.close = type_, end.ways[type_]()

    def _judge(self, end: _End, types: tuple[str, ...], barrier: str, *, fits: bool) -> None:
        before = end.doubt
        end.types, end.barrier = types, barrier
        end.unfit = None if fits else UnfitTopic(end.topic, types, tuple(end.ways))
        if end.doubt and end.doubt != before:
            log.warning("topic_unfit", topic=end.topic, reason=end.doubt)


def listening(
    node: Node, topic: str, hear: Mapping[type[Any], Callable[[Any], None]], *, raw: bool = False
) -> Mapping[str, Open]:
    """The ways to subscribe to a topic of the contract, by the classes of its messages."""

    def way(kind: type[Any]) -> Open:
        def opened() -> Close:
            quality = profile(DRIVEN[topic].qos)
            one = node.create_subscription(kind, topic, hear[kind], quality, raw=raw)
            return partial(node.destroy_subscription, one)

        return opened

    return {type_name(kind): way(kind) for kind in hear}


def _short(type_: str) -> str:
    return type_.rpartition("/")[2]


def _either(names: Any) -> str:
    return " or ".join(names)
