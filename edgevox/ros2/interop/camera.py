"""The camera's pictures go out on `image_raw`, its model on `camera_info`.

A picture may take long to render, so a thread of its own takes it and publishes it. There is no
queue: a picture that is late is skipped, not sent later.
"""

import math
from array import array

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose3D
from edgevox.robots.capabilities import CameraImage, CameraSpec, HasCamera
from edgevox.ros2.interop.frames import Frames
from edgevox.ros2.messages import header
from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import Stamps, to_msg
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose
from edgevox.ros2.ticker import Ticker

_OPTICAL = Pose3D(0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5)
"""The rotation from x forward, z up, to z forward, x right."""


class Camera:
    """Takes and publishes pictures while anybody looks, on a ticker of its own that it starts."""

    def __init__(
        self,
        node: Node,
        body: HasCamera,
        frames: Frames,
        stamps: Stamps,
        ticker: Ticker,
    ) -> None:
        self._body, self._frames, self._stamps = body, frames, stamps
        self._spec = body.camera_spec
        self._images = node.create_publisher(Image, "image_raw", profile(STANDARD["image_raw"].qos))
        self._infos = node.create_publisher(
            CameraInfo, "camera_info", profile(STANDARD["camera_info"].qos)
        )
        self._ticker = ticker
        ticker.every(1.0 / STANDARD["image_raw"].rate_hz, self._tick)

    @property
    def failures(self) -> int:
        """The number of pictures that could not be taken."""
        return self._ticker.failures

    def links(self) -> list[FramePose]:
        """Return the poses of the camera and of its optical frame."""
        names = self._frames
        parent = {"map": names.map, "body": names.base, "end_effector": names.hand}
        return [
            FramePose(parent[self._spec.parent], names.camera, self._spec.mount),
            FramePose(names.camera, names.camera_optical, _OPTICAL),
        ]

    def start(self) -> None:
        self._ticker.start()

    def close(self) -> None:
        """Take no more pictures and wait for the one that is being taken."""
        self._ticker.close()

    def _tick(self) -> None:
        if self._images.get_subscription_count() or self._infos.get_subscription_count():
            self._publish(self._body.camera())

    def _publish(self, picture: CameraImage) -> None:
        stamp_ns = self._stamps.nanoseconds(picture.time_s)
        if stamp_ns is None:
            return
        info = camera_info(self._spec)
        info.header = header(self._frames.camera_optical, to_msg(stamp_ns))
        image = image_msg(picture, self._spec)
        image.header = info.header
        self._infos.publish(info)
        self._images.publish(image)


def image_msg(picture: CameraImage, spec: CameraSpec) -> Image:
    """A picture as rgb8. Raises `InvalidValue` if it is not what the camera promised."""
    wanted = (spec.height_px, spec.width_px, 3)
    if picture.pixels.shape != wanted or picture.pixels.dtype != np.uint8:
        got = f"{picture.pixels.dtype} {picture.pixels.shape}"
        raise InvalidValue("pixels", got, f"uint8 {wanted}")
    data = array("B")  # the one type that rclpy takes without looking at every byte
    data.frombytes(np.ascontiguousarray(picture.pixels).data.cast("B"))
    return Image(
        height=spec.height_px,
        width=spec.width_px,
        encoding="rgb8",
        is_bigendian=0,
        step=3 * spec.width_px,
        data=data,
    )


def camera_info(spec: CameraSpec) -> CameraInfo:
    """The camera's model, pixels counted from the middle of the first one."""
    focal = spec.height_px / 2 / math.tan(spec.vertical_fov_rad / 2)
    cx, cy = (spec.width_px - 1) / 2, (spec.height_px - 1) / 2
    return CameraInfo(
        height=spec.height_px,
        width=spec.width_px,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[focal, 0.0, cx, 0.0, focal, cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[focal, 0.0, cx, 0.0, 0.0, focal, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )
