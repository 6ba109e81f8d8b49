"""The interface of one body to ROS 2, put together from its parts."""

from collections.abc import Callable, Mapping

from rclpy.node import Node

from edgevox.agent.policy import Guard
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock
from edgevox.robots.capabilities import (
    Body,
    HasCamera,
    HasEndEffector,
    HasLidar,
    HasPose,
    TakesVelocity,
)
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.interop.frames import Frames, broadcast_fixed
from edgevox.ros2.interop.inputs import GoalInput, RunSkill, VelocityInput, goal_skill
from edgevox.ros2.interop.outputs import Camera, ClockPublisher, MotionPublisher, Scanner
from edgevox.ros2.stamps import Stamps
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FOR_GOOD, FramePose, TfBuffer
from edgevox.ros2.ticker import MakeTicker, Ticker

log = get_logger(__name__)

TF_HZ = STANDARD["/tf"].rate_hz
SCAN_HZ = STANDARD["scan"].rate_hz
CLOCK_HZ = STANDARD["/clock"].rate_hz
_TICKS_PER_SCAN = round(TF_HZ / SCAN_HZ)


class Interop:
    """Offers on a node exactly what a body's capabilities allow, until `close`.

    Args:
        node: The node to serve on.
        body: The robot.
        run_skill: Runs a skill; must not block.
        ticker: Sets the rates; not started yet.
        backlog: Holds incoming orders.
        odom_frame: See `Frames`.
        frame_prefix: See `Frames`.
        publish_clock: See `Stamps`.
        interlock: While engaged, no velocity but zero is taken.
        guard: The policy for each velocity.
        tickers: Makes the camera's own ticker.

    Raises `InvalidValue` for an invalid frame.
    """

    def __init__(
        self,
        node: Node,
        body: Body,
        run_skill: RunSkill,
        ticker: Ticker,
        backlog: Backlog,
        *,
        odom_frame: str = "",
        frame_prefix: str = "",
        publish_clock: bool = False,
        interlock: Interlock | None = None,
        guard: Guard | None = None,
        tickers: MakeTicker = Ticker,
    ) -> None:
        self._node, self._body = node, body
        self._frames = Frames(odom_frame, frame_prefix)
        self._stamps = Stamps(node.get_clock(), lambda: body.time_s, own_clock=publish_clock)
        self._tf = TfBuffer()
        self._ticks = 0
        self._clock = ClockPublisher(node, lambda: body.time_s) if publish_clock else None
        self._motion = self._offer_motion()
        self._scanner = self._offer_scans()
        self._camera = self._offer_pictures(tickers)
        self._velocity = (
            VelocityInput(backlog, body, interlock, guard)
            if isinstance(body, TakesVelocity)
            else None
        )
        self._goal = self._take_goals(run_skill, backlog)
        self._place_sensors()
        self._forget = self._tick_on(ticker)
        if self._camera:
            self._camera.start()

    def close(self) -> None:
        """End all input and output, before the node and the body are closed."""
        for forget in self._forget:
            forget()
        for part in (self._velocity, self._goal, self._camera):
            if part:
                part.close()

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """The number of refused messages, by topic and reason; only topics that this body has."""
        parts = {"cmd_vel": self._velocity, "goal_pose": self._goal}
        return {
            (topic, reason): count
            for topic, part in parts.items()
            if part
            for reason, count in part.refusals.items()
        }

    @property
    def failed_images(self) -> int:
        """The number of pictures that could not be taken."""
        return self._camera.failures if self._camera else 0

    def _tick(self) -> None:
        """Serve both rates in one job, so that a scan and its transform nearly share a stamp."""
        self._ticks += 1
        try:
            if self._motion:
                self._motion.tick()
            if self._scanner and self._ticks % _TICKS_PER_SCAN == 0:
                self._scanner.tick()
        except EdgeVoxError as error:  # such as a sensor that is silent
            log.warning("body_unobserved", body=self._body.name, reason=str(error))

    def _tick_on(self, ticker: Ticker) -> list[Callable[[], None]]:
        """Ways to end it again."""
        forget = []
        if self._motion or self._scanner:
            forget.append(ticker.every(1.0 / TF_HZ, self._tick))
        if self._clock:
            forget.append(ticker.every(1.0 / CLOCK_HZ, self._clock.tick))
        return forget

    def _offer_motion(self) -> MotionPublisher | None:
        if not isinstance(self._body, HasPose | HasEndEffector):
            return None
        return MotionPublisher(self._node, self._body, self._frames, self._stamps, self._tf)

    def _offer_scans(self) -> Scanner | None:
        if not isinstance(self._body, HasLidar):
            return None
        return Scanner(self._node, self._body, self._frames, self._stamps, 1.0 / SCAN_HZ)

    def _offer_pictures(self, tickers: MakeTicker) -> Camera | None:
        if not isinstance(self._body, HasCamera):
            return None
        ticker = tickers("edgevox-camera")
        return Camera(self._node, self._body, self._frames, self._stamps, ticker)

    def _take_goals(self, run_skill: RunSkill, backlog: Backlog) -> GoalInput | None:
        skill = goal_skill(self._body)
        return GoalInput(backlog, skill, self._frames, self._tf, run_skill) if skill else None

    def _place_sensors(self) -> None:
        placed: list[FramePose] = []
        for sensor in (self._scanner, self._camera):
            if sensor:
                placed += sensor.links()
        self._tf.put(FOR_GOOD, *placed)
        if placed:
            broadcast_fixed(self._node, placed)
