"""What the two simulators share, where they differ, and what IR-SIM must not do to the program."""

import gc
import math
import sys
import tracemalloc
from dataclasses import astuple

import pytest
from guards import run_program

from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.irsim import IrsimEngine, IrsimRobot, irsim_config, make_environment
from edgevox.robots.world.load import apartment_file, load_world, parse_world

TWO_BOXES = """
world: {width: 8, height: 4}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 2, 0]
  vel_max: [0.8, 2.0]
  mass: 20
obstacle:
  - {name: box, shape: {name: rectangle, length: 0.4, width: 0.4}, state: [2, 2, 0],
     mass: 4, friction: 0.3}
  - {name: box, shape: {name: compound, parts: [{name: circle, radius: 0.2},
     {name: rectangle, length: 0.8, width: 0.1}]}, state: [2, 3.4, 0.3], mass: 4}
"""


@pytest.fixture(params=[PymunkEngine, IrsimEngine])
def engine(request):
    return request.param(parse_world(TWO_BOXES, "boxes.yaml"))


def test_irsim_itself_loads_the_same_file_and_stands_everything_where_we_do():
    import irsim

    theirs = irsim.make(str(apartment_file()), headless=True, log_level="CRITICAL")
    world = load_world()
    ours = make_environment(world)

    pairs = list(zip(theirs.obstacle_list, world.things, ours.obstacle_list, strict=False))
    assert len(theirs.obstacle_list) == len(world.things) == len(pairs)
    assert len(ours.obstacle_list) == len(pairs) + 4, "and the four edges"
    for there, thing, here in pairs:
        assert there.name == thing.name
        assert there.geometry.symmetric_difference(here.geometry).area < 1e-6
        assert (there.mass, there.friction) == (here.mass, here.friction) or there.static
        assert there.static == here.static != thing.movable
    assert theirs.robot.geometry.symmetric_difference(ours.robot.geometry).area < 1e-6


def test_both_lidars_see_the_same_apartment():
    engines = PymunkEngine(load_world()), IrsimEngine(load_world())
    for pose in (Pose2D(3.0, 2.0, 0.7), Pose2D(6.6, 7.2, -2.0)):
        scans = []
        for engine in engines:
            engine.put(pose, engine.movable_poses())
            scans.append(engine.scan(1.5))

        # IR-SIM has a beam at both ends of the circle, so the angles part by up to a degree.
        near = [
            abs(a - b) < 0.15 for a, b in zip(scans[0].ranges_m, scans[1].ranges_m, strict=True)
        ]
        assert sum(near) > 0.9 * len(near)
        assert scans[0].ranges_m[0] == pytest.approx(scans[1].ranges_m[0], abs=0.01)
        assert scans[0].time_s == scans[1].time_s == 1.5


def test_what_is_put_somewhere_stands_there_at_rest_and_what_was_is_forgotten(engine):
    for _ in range(60):
        pushing = engine.step(Twist2D(0.8, 0.0))
    assert pushing.touching == {"box"}
    places = (Pose2D(5.0, 1.0, 0.5), Pose2D(6.0, 3.0, 0.0))

    engine.put(Pose2D(3.0, 2.0, 1.0), places)

    motion = engine.motion()
    assert engine.still
    assert motion.touching == frozenset()
    assert astuple(motion.pose) == pytest.approx((3.0, 2.0, 1.0))
    for pose, place in zip(engine.movable_poses(), places, strict=True):
        assert astuple(pose) == pytest.approx(astuple(place))
    assert engine.step(Twist2D(0.0, 0.0)).twist == Twist2D(0.0, 0.0)


def test_a_box_is_pushed_ahead_and_slides_to_rest(engine):
    while not engine.motion().touching:
        engine.step(Twist2D(0.5, 0.0))
    for _ in range(50):
        engine.step(Twist2D(0.5, 0.0))
    for _ in range(100):
        motion = engine.step(Twist2D(0.0, 0.0))

    box, other = engine.movable_poses()
    assert engine.still
    assert 2.3 < box.x_m < 2.8
    assert box.x_m - motion.pose.x_m >= 0.4 - 1e-3, "it does not stand in the box"
    assert math.dist((other.x_m, other.y_m), (2.0, 3.4)) < 1e-6


def test_a_heavy_thing_holds_the_robot_in_irsim():
    heavy = TWO_BOXES.replace("mass: 4, friction: 0.3", "mass: 400, friction: 0.6")
    engine = IrsimEngine(parse_world(heavy, "heavy.yaml"))

    for _ in range(150):
        motion = engine.step(Twist2D(0.8, 0.0))

    assert motion.pose.x_m == pytest.approx(1.6, abs=0.01)
    assert abs(motion.twist.linear_m_s) < 0.01
    assert engine.movable_poses()[0].x_m == pytest.approx(2.0, abs=0.01)


def test_a_halt_takes_less_than_a_tenth_of_a_second(engine):
    for _ in range(20):
        engine.step(Twist2D(0.8, 1.0))
    for _ in range(5):
        motion = engine.step(Twist2D(0.0, 0.0))

    assert abs(motion.twist.linear_m_s) < 0.01
    assert abs(motion.twist.angular_rad_s) < 0.01


def test_the_same_commands_give_the_same_run_every_time():
    def run(make):
        engine = make(parse_world(TWO_BOXES, "boxes.yaml"))
        motions = [engine.step(Twist2D(0.6, 0.05 * (n % 7))) for n in range(150)]
        return motions, engine.movable_poses()

    for make in (PymunkEngine, IrsimEngine):
        assert run(make) == run(make)


def test_irsim_remembers_no_step_so_that_memory_does_not_grow():
    engine = IrsimEngine(parse_world(TWO_BOXES, "boxes.yaml"))
    for _ in range(100):
        engine.step(Twist2D(0.5, 0.1))

    tracemalloc.start()
    engine.step(Twist2D(0.5, 0.1))
    gc.collect()
    before = tracemalloc.get_traced_memory()[0]
    for _ in range(200):
        engine.step(Twist2D(0.5, 0.1))
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()

    assert grown < 200 * 100, "bytes; a step that it remembers is 500"


def test_a_polygon_whose_sides_cross_is_refused_by_irsim_with_its_field():
    bow = "[[0, 0], [1, 1], [1, 0], [0, 2]]"
    text = (
        TWO_BOXES + f"  - {{name: bow, shape: {{name: polygon, vertices: {bow}}}, state: [5, 1]}}"
    )

    with pytest.raises(InvalidValue, match=r"'bow'.*shape.vertices.*do not cross"):
        irsim_config(parse_world(text, "bow.yaml"))


def test_without_irsim_the_robot_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "irsim", None)

    with pytest.raises(
        EdgeVoxError, match=r"robot-irsim needs IR-SIM.*pip install .\.\[irsim\]. in EdgeVox's"
    ):
        IrsimRobot()


def test_irsim_is_loaded_only_for_its_robot_and_prints_nothing():
    script = """
import sys
import edgevox.apps.robots, edgevox.robots.flat.apartment
assert "irsim" not in sys.modules and "matplotlib" not in sys.modules
from edgevox.robots.flat.irsim import IrsimRobot
assert "irsim" not in sys.modules
with IrsimRobot(speed=None) as robot:
    robot.advance(0.1)
    robot.reset()
assert "irsim" in sys.modules
"""
    done = run_program([sys.executable, "-c", script])

    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
