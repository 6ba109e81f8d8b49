"""A Spot as spot_ros2 serves it: it sleeps on its dock, and says why it refuses."""

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from spot_msgs.msg import BatteryState, BatteryStateArray, DockState, Feedback, PowerState
from spot_msgs.srv import Dock, ListAllDances, SetStandHeight
from stand_in import LATCHED, PERIOD_S, StandIn, main, plain
from std_srvs.srv import Trigger

DANCES = {"learn": ["twerk", "heart"], "forget": []}


class Spot(StandIn):
    """Obeys as far as its motors are on; `refuse` makes it say that its lease is taken."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.motors, self.docked, self.standing = False, True, False
        self.dances = DANCES["learn"]
        self.x_m, self.speed_m_s = 0.0, 0.0
        self.batteries = self.create_publisher(BatteryStateArray, "status/battery_states", 1)
        self.powers = self.create_publisher(PowerState, "status/power_states", 1)
        self.docks = self.create_publisher(DockState, "status/dock_state", LATCHED)
        self.feedbacks = self.create_publisher(Feedback, "status/feedback", 1)
        self.odometry = self.create_publisher(Odometry, "odometry", 10)
        self.hears(Twist, "cmd_vel", self.walk)
        for name, state in (
            ("claim", {}),
            ("power_on", {"motors": True}),
            ("stand", {"standing": True}),
            ("sit", {"standing": False}),
            ("stop", {}),
            ("undock", {"docked": False, "standing": True}),
        ):
            self.serves(Trigger, name, state)
        self.serves(SetStandHeight, "set_stand_height", {})
        self.serves(Dock, "dock", {"docked": True, "standing": False})
        self.serves(ListAllDances, "list_all_dances", {})
        self.tell_dock()

    def serves(self, kind, name: str, state: dict[str, bool]) -> None:
        """A service that changes the state, unless Spot refuses."""

        def answer(request, response):
            self.tell(name, plain(request))
            response.success = self.mode != "refuse"
            response.message = "Success" if response.success else "the lease is taken by a tablet."
            if response.success:
                self.__dict__.update(state)
            if hasattr(response, "dances"):
                response.dances = self.dances
            self.tell_dock()
            return response

        self.create_service(kind, name, answer, callback_group=self.group)

    def walk(self, twist: Twist) -> None:
        self.speed_m_s = twist.linear.x

    def change(self, change: str) -> bool:
        if change == "sleep":
            self.motors, self.docked, self.standing, self.mode = False, True, False, "obey"
            self.tell_dock()
        elif change in DANCES:
            self.dances = DANCES[change]
        return change == "sleep" or change in DANCES

    def tell_dock(self) -> None:
        docked = DockState.DOCK_STATUS_DOCKED if self.docked else DockState.DOCK_STATUS_UNDOCKED
        self.docks.publish(DockState(status=docked))

    def say(self) -> None:
        one = BatteryState(identifier="main", charge_percentage=64.0)
        self.batteries.publish(BatteryStateArray(battery_states=[one]))
        power = PowerState.STATE_ON if self.motors else PowerState.STATE_OFF
        self.powers.publish(PowerState(motor_power_state=power))
        self.feedbacks.publish(Feedback(standing=self.standing))
        self.x_m += self.speed_m_s * PERIOD_S
        odometry = Odometry(child_frame_id="body")
        odometry.header.frame_id, odometry.header.stamp = "odom", self.get_clock().now().to_msg()
        odometry.pose.pose.position.x = self.x_m
        odometry.twist.twist.linear.x = self.speed_m_s
        self.odometry.publish(odometry)


if __name__ == "__main__":
    main(Spot, __doc__)
