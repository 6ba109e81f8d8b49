"""Tests that run beside others: their order, and that one which must be alone is."""

import threading
from pathlib import Path

from beside import ONE_NETWORK, SHARING, Room, in_turns, together
from guards import HUNG_S

ROOT = Path(__file__).parents[3]


def files(*names: str) -> list[tuple[Path, str]]:
    return [(Path("tests") / name, f"{name}::{test}") for name in names for test in ("a", "b")]


def test_what_computes_and_what_waits_take_turns_file_by_file_and_chaos_comes_last():
    found = files(
        "compose/c.py", "ros2/r.py", "ros2/test_chaos.py", "robots/b.py", "unit/u.py", "unit/v.py"
    )

    assert [one for one in in_turns(found) if one.endswith("::a")] == [
        "robots/b.py::a",
        "compose/c.py::a",
        "unit/u.py::a",
        "ros2/r.py::a",
        "unit/v.py::a",
        "ros2/test_chaos.py::a",
    ]


def test_no_test_is_lost_and_those_of_a_file_stay_together():
    found = files("elsewhere/e.py", "ros2/r.py", "unit/u.py", "ros2/test_chaos.py")

    placed = in_turns(found)

    assert sorted(placed) == sorted(test for _, test in found)
    assert [one[:-3] for one in placed[::2]] == [one[:-3] for one in placed[1::2]]


def test_files_that_share_something_costly_run_in_one_worker_and_others_by_themselves():
    for one, other in SHARING.items():
        assert (ROOT / one).is_file()
        assert (ROOT / other).is_file()
        assert together(f"{one}::test_a[x::y]") == together(f"{other}::test_b") == other
    assert together("tests/unit/u.py::test_a") == "tests/unit/u.py"


def test_no_container_comes_or_goes_while_a_browser_loads_a_page():
    assert together("tests/compose/c.py::test_a") == together("tests/browser/b.py::test_b")
    assert all((ROOT / part).is_dir() for part in ONE_NETWORK)


def test_many_share_a_room(tmp_path):
    with Room(tmp_path).shared(), Room(tmp_path).shared():
        pass


def test_whoever_wants_the_room_alone_waits_until_it_is_empty_and_then_has_it(tmp_path):
    told: list[str] = []
    inside, waiting = threading.Event(), threading.Event()

    def alone() -> None:
        waiting.set()
        with Room(tmp_path).alone():
            told.append("alone")
            inside.set()
            after.start()
            told.append("still alone")

    def late() -> None:
        with Room(tmp_path).shared():
            told.append("shared again")

    first, after = threading.Thread(target=alone), threading.Thread(target=late)
    with Room(tmp_path).shared():
        first.start()
        assert waiting.wait(HUNG_S)
        told.append("shared")
    assert inside.wait(HUNG_S)
    first.join(HUNG_S)
    after.join(HUNG_S)

    assert told == ["shared", "alone", "still alone", "shared again"]
