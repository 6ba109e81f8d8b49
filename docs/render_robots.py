"""Tells each robot what to do, in words, and takes its picture meanwhile: docs/images/robot-*.png.

The way through the apartment of `robot-apartment` has a script of its own, `render_apartment.py`.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.agent.play import ConversationHarness
from edgevox.apps.robots import build_body
from edgevox.core.settings import load_settings
from edgevox.robots.capabilities import Body
from edgevox.robots.flat.picture import picture

IMAGES = Path(__file__).parent / "images"
LIMIT_S = 60.0
STEP_S = 0.02
GAP_PX = 6
COLORS = 256
CLOSER = 10
"""Rounds in which the colours of a picture move closer to those that it has."""
MID_STEP = {"unitree_g1": 0.93, "unitree_h1": 0.98}
"""How far each has come, in metres, when a foot of it is in the air."""

Pixels = NDArray[np.uint8]
State = Mapping[str, Any]


class Director:
    """A robot with an agent, in a world whose time passes only in `until`."""

    def __init__(self, body: Body, harness: ConversationHarness) -> None:
        self.body, self._harness = body, harness

    def say(self, words: str) -> None:
        """Let it be told."""
        self._harness.say(words, LIMIT_S)

    def until(self, condition: Callable[[State], bool]) -> None:
        """Let time pass until its state is like this."""
        begun_s = self._harness.time_s
        while not condition(self.body.state()):
            if self._harness.time_s - begun_s > LIMIT_S:
                raise TimeoutError(f"{self.body.name} never came to it: {self.body.state()}")
            self._harness.let_pass(STEP_S)

    def until_done(self) -> None:
        """Let time pass until it does nothing any more."""
        self.until(lambda state: state["goal"] is None)

    def picture(self) -> Pixels:
        """How it looks now: (height, width, 3)."""
        return self.body.picture()


@contextmanager
def directed(robot: str, **flags: object) -> Iterator[Director]:
    """A robot that listens, without a language model."""
    settings = load_settings({"text_mode": True, "llm": "none", **flags})
    with ExitStack() as stack:
        body = build_body(robot, settings, 0.0)
        parts = build_parts(stack, settings, body)
        harness = ConversationHarness(parts.bus, parts.conversation, body)
        stack.callback(harness.close)
        start_parts(stack, parts)
        stack.callback(harness.come_to_rest, LIMIT_S)
        yield Director(body, harness)


def irsim() -> Pixels:
    """The way to the bedroom, to the office and to the kitchen."""
    with directed("robot-irsim") as robot:
        for room in ("bedroom", "office", "kitchen"):
            robot.say(f"go to the {room}")
            robot.until_done()
        body = robot.body
        image = picture(
            body.world,
            body.pose(),
            body.movable_poses(),
            trail=body.trail(),
            scan=body.scan(),
            width_px=900,
        )
        return np.asarray(image)


def panda() -> Pixels:
    """A cube on its way into a bin: grasped, carried, let go."""
    with directed("robot-panda") as robot:
        robot.say("put the red cube into the left bin")
        robot.until(lambda state: state["held"] == "red_cube")
        shown = [robot.picture()]
        robot.until(lambda state: carried(state) and state["objects"]["red_cube"]["y"] > 0.25)
        shown.append(robot.picture())
        robot.until(lambda state: carried(state) and state["held"] is None)
        robot.until_done()
        shown.append(robot.picture())
    return side_by_side(shown, crop=(80, 0, 560, 480))


def carried(state: State) -> bool:
    """Whether the red cube has left its place."""
    return bool(state["objects"]["red_cube"]["y"] > 0.1)


def humanoids() -> Pixels:
    """Two robots on their way."""
    shown = []
    for source, x_m in MID_STEP.items():
        with directed("robot-humanoid", model_source=source) as robot:
            robot.say("walk forward two metres")
            robot.until(lambda state, x_m=x_m: state["pose"]["x"] > x_m)
            shown.append(robot.picture())
    return side_by_side(shown, crop=(120, 50, 520, 430))


def side_by_side(pictures: list[Pixels], crop: tuple[int, int, int, int]) -> Pixels:
    """Cut out left, top, right, bottom of each, and put them in a row."""
    left, top, right, bottom = crop
    height, width = bottom - top, right - left
    row = np.full((height, len(pictures) * (width + GAP_PX) - GAP_PX, 3), 255, np.uint8)
    for number, one in enumerate(pictures):
        at = number * (width + GAP_PX)
        row[:, at : at + width] = one[top:bottom, left:right]
    return row


PICTURES: Mapping[str, Callable[[], Pixels]] = {
    "robot-irsim": irsim,
    "robot-panda": panda,
    "robot-humanoid": humanoids,
}


def main(names: list[str]) -> None:
    """Render the pictures of these names, or all of them."""
    IMAGES.mkdir(exist_ok=True)
    for name in names or PICTURES:
        image = Image.fromarray(PICTURES[name]())
        small = image.quantize(COLORS, Image.Quantize.MAXCOVERAGE, CLOSER)
        small.save(IMAGES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
