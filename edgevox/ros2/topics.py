"""The topics of `contract`: events go out, and what comes in becomes commands; and `picture`."""

from array import array
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.node import Node
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float32, String

from edgevox.agent.policy import CheckedCall, Denied
from edgevox.core.agent_events import AgentEvent
from edgevox.core.bus import Bus
from edgevox.core.commands import CancelProgram, Reset, Way
from edgevox.core.errors import EdgeVoxError, InvalidValue, Refusal
from edgevox.core.events import PictureTaken, RobotState
from edgevox.core.log import get_logger
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.contract import PUBLISHED, SUBSCRIBED
from edgevox.ros2.contract_rows import STRING, Published, Subscribed
from edgevox.ros2.messages import header, profile
from edgevox.ros2.open import BridgeContext
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.ticker import Ticker

log = get_logger(__name__)

_TYPES: dict[str, Any] = {STRING: String, "std_msgs/msg/Float32": Float32}
_PNG = "rgb8; png compressed rgb8"
"""The format, as image_transport's plug-in of compressed images writes it."""


class Topics:
    """Serves the rows of `PUBLISHED` and `SUBSCRIBED` on a node.

    The ticker reads the body's state, if there is a body, at the rate of the settings. `refusals`
    counts invalid and forbidden messages by topic and reason.
    """

    def __init__(
        self, node: Node, context: BridgeContext, ticker: Ticker, backlog: Backlog
    ) -> None:
        self._node = node
        self._bus = context.bus
        self._submit = context.submit
        self._guard = context.guard
        self.refusals: Counter[tuple[str, ...]] = Counter(
            {(row.topic, Refusal.INVALID): 0 for row in SUBSCRIBED}
            | {(row.topic, Refusal.FORBIDDEN): 0 for row in SUBSCRIBED if row.verbs}
        )
        self._forget: list[Callable[[], None]] = []
        body = context.body
        for published in PUBLISHED:
            if body or published.event not in (RobotState, AgentEvent):
                self._publish(published)
        for subscribed in SUBSCRIBED:
            backlog.subscribe(
                String,
                subscribed.topic,
                partial(self._receive, subscribed),
                profile(subscribed.qos),
            )
        if body:
            self._forget.append(
                ticker.every(
                    1.0 / context.settings.ros2_state_hz,
                    lambda: self._bus.publish(RobotState(body.state())),
                )
            )

    def close(self) -> None:
        """Publish nothing more."""
        for forget in self._forget:
            forget()

    def _publish(self, row: Published) -> None:
        kind = _TYPES[row.type]
        publisher = self._node.create_publisher(kind, row.topic, profile(row.qos))
        self._forget.append(
            self._bus.subscribe(
                row.event, lambda event: publisher.publish(kind(data=row.encode(event)))
            )
        )

    def _receive(self, row: Subscribed, message: String, mark: int) -> None:
        try:
            command = row.decode(message.data)
            if row.verbs and not isinstance(command, Reset | CancelProgram):  # to end is free
                self._guard.permit(Way.COMMAND, [CheckedCall(message.data.strip(), moves=False)])
            self._submit(command, mark)
        except InvalidValue as error:
            self._refuse(row.topic, error.reason, error)
        except Denied as denied:
            self._refuse(row.topic, Refusal.FORBIDDEN, denied)

    def _refuse(self, topic: str, why: Refusal, error: EdgeVoxError) -> None:
        self.refusals[topic, why] += 1
        log.warning("message_refused", topic=topic, reason=str(error))


class PicturePublisher:
    """Publishes each picture that the robot was asked to take, latched on `picture`."""

    def __init__(self, node: Node, bus: Bus, frame: str) -> None:
        """`frame` is the camera's optical frame."""
        row = STANDARD["picture"]
        publisher = node.create_publisher(CompressedImage, row.topic, profile(row.qos))

        def publish(event: PictureTaken) -> None:
            data = array("B")  # the one type that rclpy takes without looking at every byte
            data.frombytes(event.png)
            head = header(frame, node.get_clock().now().to_msg())
            publisher.publish(CompressedImage(header=head, format=_PNG, data=data))

        self.close = bus.subscribe(PictureTaken, publish)
