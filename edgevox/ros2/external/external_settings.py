"""How a robot is driven: limits, and how long to be patient with it."""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class SteeringLimits:
    """How it is steered where nothing there takes goals."""

    max_linear_m_s: float = 0.3
    max_angular_rad_s: float = 0.8
    max_linear_m_s2: float = 0.5
    half_width_m: float = 0.3
    stop_ahead_m: float = 0.5
    """Something this near ahead of the robot's middle makes it wait."""
    wait_s: float = 10.0
    """So long it waits for what is in its way to go."""


@dataclass(frozen=True, slots=True)
class Patience:
    """How long a drive may go on without moving, without coming nearer, and at all."""

    unmoved_s: float
    no_nearer_s: float
    first_s: float = 60.0
    slowest_m_s: float = 0.02
    """After `first_s` seconds, a drive that was slower than this as the crow flies has failed."""


@dataclass(frozen=True, slots=True)
class ExternalSettings:
    """What `ExternalRobot` needs to know besides its namespace and its locations."""

    steering: SteeringLimits = field(default_factory=SteeringLimits)
    steering_patience: Patience = Patience(unmoved_s=5.0, no_nearer_s=20.0)
    # What plans by itself may think, take a detour and recover.
    goal_patience: Patience = Patience(unmoved_s=15.0, no_nearer_s=60.0, first_s=600.0)
    discovery_s: float = 3.0
    """So long after the start the robot may take to be discovered."""
    remappings: tuple[str, ...] = ()
    """ROS arguments that give the contract's topics the names that the robot has."""
    obey_s: float = 5.0
    """So long a halted robot may take to stand."""
