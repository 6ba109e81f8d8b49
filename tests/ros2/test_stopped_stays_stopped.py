"""What was asked for before a stop is void, whoever asked and however far it has come.

And what comes after it counts. The robot's own velocity is the witness.
"""

import signal

import pytest
from std_msgs.msg import String
from watched_robot import (
    BUTTON,
    LET_GO_S,
    STOPS,
    WatchedRobot,
    resume,
    stop,
)


def long(value, **names):
    return pytest.param(value, marks=pytest.mark.long, **names)


def every_way(*short):
    """Every way of stopping; those that are not named are for the long run."""
    assert set(short) <= STOPS.keys()
    return [one if one in short else long(one) for one in STOPS]


@pytest.fixture(scope="module")
def home(domain, tmp_path_factory):
    robot = WatchedRobot(domain, tmp_path_factory.mktemp("console"))
    yield robot
    robot.close()


@pytest.fixture
def robot(home):
    """It stands, nothing is asked of it, and no stream of before goes on."""
    stop(home, BUTTON)
    resume(home)
    home.passes(LET_GO_S)
    return home


@pytest.mark.parametrize("way", every_way("text_input", "execute_skill stop", "command reset"))
@pytest.mark.parametrize("number", [10, long(3), long(20)])
def test_no_goal_of_a_burst_begins_after_the_stop_that_follows_it(robot, number, way):
    robot.send_goals(number)
    robot.has_received()

    stop(robot, way)

    robot.stays()
    _counts_again(robot, way)
    robot.drives()


@pytest.mark.parametrize("way", every_way("interrupt", "standard input", "a word on the page"))
def test_a_sentence_that_waits_behind_a_long_answer_is_void(robot, way):
    robot.think()
    robot.peer.send("text_input", robot.sentence_to())
    robot.type(robot.sentence_to())
    robot.type(robot.sentence_to())

    stop(robot, way)

    robot.stays()
    _counts_again(robot, way)
    robot.peer.send("text_input", robot.sentence_to())
    robot.moves()


@pytest.mark.parametrize("way", every_way(BUTTON, "the skill on the page"))
@pytest.mark.parametrize("hand", ["stick", long("joystick")])
def test_a_stream_that_goes_on_over_a_stop_counts_again_once_it_was_let_go(robot, hand, way):
    stream = getattr(robot, hand)()
    try:
        robot.moves()
        since = len(robot.state.messages)
        stop(robot, way)
        if way == BUTTON:
            robot.stays()
            resume(robot)
        try:
            robot.stays()
        except AssertionError:
            if robot.was_steady(since):
                raise
    finally:
        stream.end()
    robot.passes(LET_GO_S)

    stream = getattr(robot, hand)()
    try:
        robot.moves()
    finally:
        stream.end()


@pytest.mark.parametrize("way", ["interrupt", long("text_input"), long("execute_skill stop")])
@pytest.mark.parametrize("number", [10, long(2), long(25)])
def test_no_point_that_a_page_has_sent_is_driven_to_after_a_stop(robot, number, way):
    points = [robot.page.send(type="goto", **robot.target()) for _ in range(number)]

    stop(robot, way)

    robot.stays()
    for asked in points:
        assert robot.page.answer(asked)["type"] in ("ok", "error")
    robot.page.ask(type="goto", **robot.target())
    robot.moves()


def test_the_skill_on_a_page_does_not_wait_for_the_models_answer(robot):
    robot.think()
    robot.drives()

    robot.page.ask(type="skill", name="stop", arguments={})

    robot.stays()


@pytest.mark.parametrize("thinks", [True, long(False)])
def test_text_typed_on_a_page_while_it_is_stopped_is_not_obeyed_after_resume(robot, thinks):
    if thinks:
        robot.think()
        robot.page.send(type="text", text=robot.sentence_to())
    robot.page.ask(type="stop")
    robot.page.send(type="text", text=robot.sentence_to())
    robot.peer.send("text_input", robot.sentence_to())
    robot.send_pose()
    robot.has_received()

    resume(robot)

    robot.stays()
    robot.page.ask(type="text", text=robot.sentence_to())
    robot.moves()


@pytest.mark.parametrize(
    "stops",
    [
        pytest.param(lambda robot: robot.peer.send("text_input", "stop"), id="text_input"),
        pytest.param(lambda robot: robot.page.send(type="stop"), id=BUTTON),
        long(lambda robot: robot.interrupt.publish(String()), id="interrupt"),
        long(lambda robot: robot.page.send(type="text", text="stop"), id="a word on the page"),
    ],
)
def test_nothing_that_lies_in_the_queues_of_a_robot_that_hangs_is_done_after_the_stop(robot, stops):
    robot.agent.process.send_signal(signal.SIGSTOP)
    try:
        robot.send_goals(10)
        for _ in range(5):
            robot.peer.send("text_input", robot.sentence_to())
            robot.send_pose()
            robot.page.send(type="goto", **robot.target())
            robot.type(robot.sentence_to())
        stops(robot)
    finally:
        robot.agent.process.send_signal(signal.SIGCONT)
    robot.has_heard_all()

    robot.stays()
    resume(robot)
    robot.drives()


def _counts_again(robot, way):
    if way == BUTTON:
        resume(robot)
        robot.stays()
