"""What each way to stop ends, as docs/ros2.md has it in its table."""

from collections.abc import Callable

import pytest
from stop_game import StopGame

from edgevox.core.commands import Interrupt, Way
from edgevox.core.events import Cause
from edgevox.core.motion.interlock import StreamStopped

ALL = {
    "the goal that moves",
    "programs",
    "the question that stands",
    "what was sent before and comes later",
    "velocities that go on",
}
HUSHES = set[str]()
"""Who speaks over the robot, or says its wake word, only silences it."""


def hush(game: StopGame, cause: Cause) -> None:
    game.conversation.submit(Interrupt(motion=False, cause=cause))


ENDS: dict[str, tuple[Callable[[StopGame], object], set[str]]] = {
    "a stop word, typed": (StopGame.type_a_stop_word, ALL),
    "a stop word, spoken": (StopGame.say_a_stop_word, ALL),
    "a stop word, by its sound": (StopGame.say_one_that_is_known_by_its_sound, ALL),
    "interrupt": (StopGame.interrupt, ALL),
    "the skill stop, as an action": (StopGame.call_the_skill_by_the_action, ALL),
    "the skill stop, as a command": (StopGame.call_the_skill_as_a_command, ALL),
    "the page's Stop": (lambda game: game.software_stop.stop("a phone"), ALL),
    "reset": (StopGame.reset, ALL),
    "speaking over it": (lambda game: hush(game, Cause.BARGE_IN), HUSHES),
    "its wake word": (lambda game: hush(game, Cause.WAKE_WORD), HUSHES),
}


@pytest.mark.parametrize("way", ENDS)
def test_it_ends_what_the_table_says(way: str) -> None:
    stop, ends = ENDS[way]
    game = StopGame()
    try:
        assert ended(game, lambda: stop(game)) == ends
    finally:
        game.conversation.close()


def ended(game: StopGame, stop: Callable[[], object]) -> set[str]:
    """What of all that can be under way this ends."""
    game.send_an_order_for_later(5, held=False)
    program = game.orders
    game.be_asked(held=False)
    asked = game.orders
    game.send_goal(Way.ACTION, False, held=False)
    game.body.starts_until_driving(game.orders)
    game.speak(held=True)
    late = game.orders

    stop()

    found = {"the goal that moves"} if game.body.drives_for is None else set()
    if game.forbidden:
        game.software_stop.resume("a phone")
    game.say("yes", held=False)
    found |= {"the question that stands"} if not game.has_begun(asked) else set()
    game.waiting.pop()()
    game.settle()
    found |= {"what was sent before and comes later"} if not game.has_begun(late) else set()
    game.time_passes(10.0)
    found |= {"programs"} if not game.has_begun(program) else set()
    return found | ({"velocities that go on"} if stream_ends(game, stop) else set())


def stream_ends(game: StopGame, stop: Callable[[], object]) -> bool:
    game.steering.let_go()
    game.steering.steer(0.3, 0.0)
    stop()
    if game.forbidden:
        game.software_stop.resume("a phone")
    game.time.advance(0.1)
    try:
        game.steering.steer(0.3, 0.0)
    except StreamStopped:
        return True
    return False
