"""A small part of the stop game, always the same; `make games` plays it for as long as you want."""

from hypothesis import settings
from hypothesis.stateful import run_state_machine_as_test
from stop_game import StopGame


def test_no_motion_lasts_or_begins_after_a_stop_unless_what_was_sent_after_it_asked_for_it():
    run_state_machine_as_test(StopGame, settings=settings(max_examples=60, stateful_step_count=30))
