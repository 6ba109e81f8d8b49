"""A few rounds of the stop game with a real agent, always the same; `make games` plays on."""

import os
import random
import time

import pytest
from stop_game_on_the_wire import StopGameOnTheWire
from watched_robot import WatchedRobot

pytestmark = pytest.mark.long

SECONDS = float(os.environ.get("STOP_GAME_S", "0"))
"""How long it is played with seeds of its own, instead."""
ROUNDS = 10


@pytest.fixture(scope="module")
def robot(domain, tmp_path_factory):
    one = WatchedRobot(domain, tmp_path_factory.mktemp("console"))
    yield one
    one.close()


def test_nothing_moves_after_a_stop_unless_what_was_sent_after_it_asked_for_it(robot, request):
    tell = request.config.get_terminal_writer().line
    begun_s, seed = time.monotonic(), 1
    if SECONDS:
        seed = int(os.environ.get("STOP_GAME_SEED") or random.SystemRandom().randrange(1 << 32))
        tell(f"STOP_GAME_SEED={seed}")
    game, played = StopGameOnTheWire(robot, seed), 0

    while played < ROUNDS or time.monotonic() - begun_s < SECONDS:
        game.play_round()
        played += 1

    tell(f"{played} rounds")
