"""What a message of `robot_state` says of a robot on wheels."""

import json


def moving(message: str) -> bool:
    """True if it drives; while its odometry is not heard, it has no velocity."""
    velocity = json.loads(message)["velocity"]
    return velocity is not None and velocity["linear"] > 0.05


def standing(message: str) -> bool:
    velocity = json.loads(message)["velocity"]
    return abs(velocity["linear"]) < 0.01 and abs(velocity["angular"]) < 0.01


def far_room(message: str) -> str:
    """A room of the apartment that it needs a while to drive to."""
    return ("kitchen", "bedroom")[json.loads(message)["pose"]["x"] > 5.0]
