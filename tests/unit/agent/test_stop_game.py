"""A small part of the stop game, always the same; `make games` plays it for as long as you want."""

import os
import random
import time

import pytest
from hypothesis import seed, settings
from hypothesis.stateful import run_state_machine_as_test
from stop_game import StopGame

SECONDS = float(os.environ.get("STOP_GAME_S", "0"))
"""How long it is played with seeds of its own, instead; `STOP_GAME_SEED` names the first."""
SAME = settings(max_examples=60, stateful_step_count=30)
ANY = settings(SAME, derandomize=False)


def test_no_motion_lasts_or_begins_after_a_stop_unless_what_was_sent_after_it_asked_for_it(
    request: pytest.FixtureRequest,
) -> None:
    if not SECONDS:
        run_state_machine_as_test(StopGame, settings=SAME)
    begun_s, asked = time.monotonic(), os.environ.get("STOP_GAME_SEED")
    while time.monotonic() - begun_s < SECONDS:
        number = int(asked) if asked else random.SystemRandom().randrange(1 << 32)
        request.config.get_terminal_writer().line(f"STOP_GAME_SEED={number}")
        run_state_machine_as_test(seed(number)(StopGame), settings=ANY)
