"""ROS 2 for a skill's code: it uses the agent's own node, and never makes one."""

from collections.abc import Callable
from typing import Any, Protocol, TypeVar, runtime_checkable

from edgevox.core.cancel import CancelToken

T = TypeVar("T")


class NodeHandle(Protocol):
    """The agent's node, for a skill: give each wait the token of the skill's goal.

    Names are relative to the node's namespace (on `robot-external` the robot's, with the topics of
    its robot file) unless they begin with a slash. `kind` is the class of the interface, such as
    ``std_srvs.srv.Trigger``. All methods may be called from any thread but the node's. The methods
    that wait raise `Cancelled` when the token is cancelled, and `SkillFailed`, with a reason in
    every language of the robot, if the interface is missing, refuses, is silent or gives up. Only
    `listen` can be used before the robot is started.
    """

    def call(
        self, kind: Any, name: str, request: Any, *, token: CancelToken, timeout_s: float = 10.0
    ) -> Any:
        """The answer of a service."""

    def run(
        self,
        kind: Any,
        name: str,
        goal: Any,
        *,
        token: CancelToken,
        timeout_s: float = 60.0,
        hear: Callable[[Any], None] = lambda _: None,
    ) -> Any:
        """The result of an action that succeeded; `hear` gets its feedback, on this thread.

        When the token is cancelled, the time is over or `hear` raises, the action is cancelled and
        has a few seconds to end.
        """

    def publish(
        self, kind: Any, name: str, message: Any, *, token: CancelToken, latched: bool = False
    ) -> None:
        """Publish once, to somebody who listens; what is latched waits for who listens later.

        As always on ROS 2, the first message of a topic may be lost to a listener that does not
        know of its publisher yet: what must not be lost is a service's or an action's.
        Raises `InvalidValue` for velocities: `set_velocity` of the body keeps limits and policy.
        """

    def listen(self, kind: Any, name: str, *, latched: bool = False) -> None:
        """Hear a topic from now on, so that `latest` has an answer at once."""

    def latest(
        self,
        kind: Any,
        name: str,
        *,
        token: CancelToken,
        oldest_s: float = 5.0,
        timeout_s: float = 5.0,
        latched: bool = False,
    ) -> Any:
        """The newest message of a topic, if it is no older; else the next one.

        A topic that is latched says something once, which never gets too old.
        """

    def wait_for(
        self,
        kind: Any,
        name: str,
        fits: Callable[[Any], bool],
        *,
        token: CancelToken,
        timeout_s: float,
        oldest_s: float = 5.0,
        latched: bool = False,
    ) -> Any:
        """The first message that fits, be it the newest now, if that is no older.

        With an `oldest_s` of 0 only what comes from now on counts. `fits` is quick.
        """

    def on_node(self, work: Callable[[Any], T]) -> T:
        """Return what `work` makes of the `rclpy.node.Node`, on the one thread that spins it.

        For needs beyond the other methods: timers, parameters, other QoS. It must not wait there,
        and neither may any callback that it leaves behind: the robot's own topics wait for it.
        """


@runtime_checkable
class OnRos2(Protocol):
    """A body whose robot is on ROS 2 has a node there, in the robot's namespace."""

    @property
    def ros(self) -> NodeHandle:
        """The node, for skills."""
