"""`robot-humanoid`: a robot on two legs, in real time or as fast as it can.

`HumanoidCameras` are the view from its head, and that of a person who walks beside it.
"""

import math
import threading
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import Skill, SkillFailed
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.errors import finite
from edgevox.core.transforms import Pose2D, compose_on_floor, pitch
from edgevox.robots.capabilities import CameraImage, CameraSpec, Report, Twist2D
from edgevox.robots.command_mux import CommandMux
from edgevox.robots.humanoid.environment import HEAD_CAMERA, MujocoHumanoidEnvironment
from edgevox.robots.humanoid.walk_control import MotionPrimitive, WalkControl, describe
from edgevox.robots.mujoco.renderer import PICTURE_PX, Renderer, Snapshot
from edgevox.robots.relative_skills import walking_skills, where
from edgevox.robots.sim_loop import BROKE, SimLoop, SimulatedBody, SteppedBySimLoop

WIDTH_PX, HEIGHT_PX = 320, 240
VERTICAL_FOV_RAD = math.radians(60.0)
DOWN_RAD = math.radians(25.0)
"""The tilt of the head camera: a robot that walks looks where it goes."""
_HEAD = 1.6
"""Height of the eyes, of the pelvis's when it stands."""
_FACE_M = 0.22
"""The camera's distance ahead of the pelvis: in front of the face, even while the body leans."""
_BESIDE_RAD = math.radians(145.0)
_ABOVE_DEG = -12.0
_AWAY = 3.4


class HumanoidCameras:
    """Renders on its own thread. `look` needs the world's lock, the others do not.

    The head camera hangs in the frame of the robot's pose on the floor, always level and at one
    height, as if a gimbal held it. So its picture agrees with its transform, which it would not if
    the camera swayed with the body; and a robot that lies on the floor still sees from there.
    """

    def __init__(self, environment: MujocoHumanoidEnvironment, *, name: str) -> None:
        self._environment = environment
        self._stand_m = environment.stand_height_m
        self._height_m = _HEAD * self._stand_m
        self.camera_spec = CameraSpec(
            WIDTH_PX,
            HEIGHT_PX,
            VERTICAL_FOV_RAD,
            replace(pitch(DOWN_RAD), x_m=_FACE_M, z_m=self._height_m),
        )
        environment.model.cam(HEAD_CAMERA).fovy[:] = math.degrees(VERTICAL_FOV_RAD)
        self._renderer = Renderer(environment.model, *PICTURE_PX, name=name)

    def look(self, time_s: float) -> Snapshot:
        """A copy of this moment, to be drawn."""
        face = compose_on_floor(self._environment.pose, Pose2D(_FACE_M, 0.0, 0.0))
        return self._environment.snapshot(time_s, face, self._height_m, DOWN_RAD)

    def head(self, moment: Snapshot) -> CameraImage:
        """Return the head camera's picture of that moment."""
        size = (WIDTH_PX, HEIGHT_PX)
        return CameraImage(moment.time_s, self._renderer.render(HEAD_CAMERA, moment, size_px=size))

    def beside(self, moment: Snapshot, pose: Pose2D) -> NDArray[np.uint8]:
        """The robot, which stood there, from ahead and beside, (480, 640, 3)."""
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        camera.lookat[:] = pose.x_m, pose.y_m, 0.85 * self._stand_m
        camera.distance = _AWAY * self._stand_m
        camera.azimuth = math.degrees(pose.yaw_rad + _BESIDE_RAD)
        camera.elevation = _ABOVE_DEG
        return self._renderer.render(camera, moment, fine=True)

    def close(self) -> None:
        """Free OpenGL and join the thread."""
        self._renderer.close()


FALLEN = because("fallen")


class HumanoidRobot(SteppedBySimLoop, SimulatedBody):
    """A humanoid with a pose and a head camera, whose legs obey a sentence or a velocity stream.

    Args:
        environment: The robot in its world, owned by this body from now on.
        speed: Seconds of its world per second: 1 is real time. None, for tests, is as fast as
            possible during a motion or until it stands, and otherwise, even during a velocity
            stream, only as far as `advance` asks. 0 is always only as far as `advance` asks.
        clock: The time; the system's by default.

    Every method may be called from any thread. A cancelled or halted robot gets zero velocity
    before the call returns. In physics it cannot stop a step in mid-air: it sets that foot down and
    stands within about 1.5 s of its own time, on its feet. Without physics, its base stops at once
    and its feet come together.
    """

    name = "robot-humanoid"

    def __init__(
        self,
        environment: MujocoHumanoidEnvironment,
        *,
        speed: float | None = 1.0,
        clock: Clock | None = None,
    ) -> None:
        self._environment = environment
        self._period_s = environment.period_s
        self.max_linear_m_s = environment.limits.forward_m_s
        self.max_angular_rad_s = environment.limits.turn_rad_s
        self._lock = threading.RLock()
        self._mux: CommandMux[MotionPrimitive] = CommandMux(
            self._lock,
            max_linear_m_s=self.max_linear_m_s,
            max_angular_rad_s=self.max_angular_rad_s,
            on_halt=lambda *_: self._walk.forget_heading(),
        )
        self._walk = WalkControl(self._mux, environment.limits, self._period_s)
        self._eyes = HumanoidCameras(environment, name=self.name)
        self._always = speed is not None
        self._ticks = 0
        self._wanted_ticks = 0
        self._skills = walking_skills(self)
        self._sim_loop = SimLoop(
            self._step,
            period_s=self._period_s,
            speed=speed,
            clock=clock,
            name=f"{self.name} world",
            broke=self._give_up,
        )

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        return self._ticks * self._period_s

    @property
    def watchdog_halts(self) -> int:
        return self._mux.watchdog_halts

    @property
    def camera_spec(self) -> CameraSpec:
        """The camera in the head, held level above the point between the feet as if on a gimbal."""
        return self._eyes.camera_spec

    def start(self) -> None:
        self._sim_loop.start()

    def _close(self) -> None:
        self._sim_loop.close()
        self._eyes.close()

    def reset(self) -> None:
        """Back upright where it started; time goes on."""
        with self._lock:
            self._mux.halt(Cancelled(called_off("world_reset")))
            self._walk = WalkControl(self._mux, self._environment.limits, self._period_s)
            self._environment.reset()

    def pose(self) -> Pose2D:
        with self._lock:
            return self._environment.pose

    def velocity(self) -> Twist2D:
        with self._lock:
            return self._environment.velocity

    def camera(self) -> CameraImage:
        with self._lock:
            moment = self._eyes.look(self.time_s)
        return self._eyes.head(moment)

    def picture(self) -> NDArray[np.uint8]:
        with self._lock:
            moment, pose = self._eyes.look(self.time_s), self._environment.pose
        return self._eyes.beside(moment, pose)

    def set_velocity(self, twist: Twist2D) -> None:
        """Follow this velocity, see `TakesVelocity`. A robot that lies on the floor stays there."""
        with self._lock:
            self._mux.stream(twist, self.time_s)
            self._walk.forget_heading()
        self._sim_loop.wake()

    def halt(self, reason: str) -> bool:
        with self._lock:
            moved = self._walk.busy
            self._mux.halt(Cancelled(reason))
        self._sim_loop.wake()
        return moved

    def walk(self, distance_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until it stands that many metres ahead, or back if negative.

        Raises `SkillFailed` with a reason (it fell, it cannot get further), `Cancelled` if it was
        ended: by its token, a halt, a velocity or another motion.
        """
        self._perform(token, report, distance_m=finite("distance", distance_m))

    def turn(self, angle_rad: float, *, token: CancelToken, report: Report) -> None:
        """Turn like `walk`, to the left by `angle_rad`, right if negative."""
        self._perform(token, report, angle_rad=finite("angle", angle_rad))

    def stand(self, *, token: CancelToken, report: Report) -> bool:
        """Block until it stands still. A fallen robot is put upright where it lies.

        Then return True.
        """
        token.check()
        with self._lock:
            got_up = self._environment.fallen
            if got_up:
                self._environment.stand_up()
        self._perform(token, report)
        return got_up

    def state(self) -> Mapping[str, Any]:
        with self._lock:
            return {
                "name": self.name,
                "time": round(self.time_s, 3),
                **describe(self._environment, self._mux.motion, walking=self._walk.walking),
            }

    @property
    def in_motion(self) -> bool:
        """Whether a goal moves it."""
        return self._mux.motion is not None

    def advance(self, seconds: float) -> None:
        """Block until this much of the world's time has passed."""
        with self._lock:
            until = self._ticks + max(1, round(seconds / self._period_s))
            self._wanted_ticks = max(self._wanted_ticks, until)
        while self._sim_loop.running and self._ticks < until:
            self._sim_loop.advance((until - self._ticks) * self._period_s)

    def _perform(
        self,
        token: CancelToken,
        report: Report,
        *,
        distance_m: float = 0.0,
        angle_rad: float = 0.0,
    ) -> None:
        token.check()
        motion = self._mux.start(lambda: self._primitive(distance_m, angle_rad))
        self._sim_loop.wake()
        self._mux.carry_out(motion, token, lambda: self._report(motion, report))

    def _primitive(self, distance_m: float, angle_rad: float) -> MotionPrimitive:
        if not self._sim_loop.running:
            raise SkillFailed(because("switched_off"))
        if self._environment.fallen:
            raise SkillFailed(FALLEN)
        return MotionPrimitive(
            self._walk.aligned(self._environment.pose),
            self._environment.limits,
            self._period_s,
            distance_m=distance_m,
            angle_rad=angle_rad,
        )

    def _give_up(self) -> None:
        """End the motion after a failed period: the next one might do anything with it."""
        self._mux.halt(SkillFailed(BROKE))

    def _report(self, motion: MotionPrimitive, report: Report) -> None:
        with self._lock:
            progress, pose = motion.progress(), self._environment.pose
        report(**progress.as_values(), **where(pose))

    def _step(self) -> bool:
        """Do a period of the world, on the sim loop's thread. Return whether more is to come."""
        with self._lock:
            if self._always or self._due():
                self._pass_period()
            return self._due()

    def _due(self) -> bool:
        """Return whether time is to pass, if it does not pass by itself."""
        driven = self._walk.busy and self._mux.velocity is None
        return driven or self._ticks < self._wanted_ticks

    def _pass_period(self) -> None:
        self._ticks += 1
        environment, walk = self._environment, self._walk
        environment.step(walk.command(self.time_s, environment.pose))
        if environment.fallen and walk.busy:
            self._mux.halt(SkillFailed(FALLEN))
