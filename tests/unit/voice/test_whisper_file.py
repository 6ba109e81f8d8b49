"""A model's file with something added to its weights: they alone change, nothing is guessed."""

import os
import struct

import numpy as np
import pytest
from whisper_files import BYTES, HALF, SINGLE, WEIGHTS, array, file_of

from edgevox.voice.stt.adapter import FILE, Added, NotAWhisperFile, adapted, adapted_folder, arrays


def column(numbers) -> Added:
    """So many numbers to add, as a product."""
    return Added(np.asarray(numbers, np.float32)[:, None], np.ones((1, 1), np.float32))


BIAS = np.ones(4, np.float32)
CODES = np.arange(5, dtype=np.int8)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "config.json").write_bytes(b"{}")
    held = (
        array("encoder/weight", HALF, WEIGHTS),
        array("encoder/bias", SINGLE, BIAS),
        array("decoder/codes", BYTES, CODES),
    )
    (tmp_path / FILE).write_bytes(file_of(*held))
    return tmp_path


def test_with_nothing_added_all_files_are_as_they_were(folder):
    assert adapted(folder, {}) == (folder / FILE).read_bytes()


def test_what_is_added_is_added_to_that_array_alone(folder):
    more = Added(np.array([[1, 1], [2, 2]], np.float32), np.full((2, 3), 0.25, np.float32))

    (folder / FILE).write_bytes(adapted(folder, {"encoder/weight": more}))

    found = arrays(folder, "encoder/")
    assert set(found) == {"encoder/weight", "encoder/bias"}
    np.testing.assert_array_equal(found["encoder/weight"], WEIGHTS + np.array([[0.5], [1]]))
    np.testing.assert_array_equal(found["encoder/bias"], BIAS)


def test_arrays_of_either_precision_are_added_to(folder):
    found = adapted(folder, {"encoder/bias": column(range(4))})

    (folder / FILE).write_bytes(found)
    np.testing.assert_array_equal(arrays(folder, "encoder/bias")["encoder/bias"], [1, 2, 3, 4])


def test_several_arrays_are_added_to_in_whatever_order(folder):
    added = {"encoder/bias": column(np.ones(4)), "encoder/weight": column(np.ones(6))}

    (folder / FILE).write_bytes(adapted(folder, added))

    found = arrays(folder, "encoder/")
    np.testing.assert_array_equal(found["encoder/weight"], WEIGHTS + 1)
    np.testing.assert_array_equal(found["encoder/bias"], BIAS + 1)
    last = array("decoder/codes", BYTES, CODES) + struct.pack("<I", 0)
    assert (folder / FILE).read_bytes().endswith(last)


def test_the_folder_itself_does_not_change(folder):
    before = (folder / FILE).read_bytes()

    adapted(folder, {"encoder/weight": column(np.ones(6))})

    assert (folder / FILE).read_bytes() == before


@pytest.mark.parametrize(
    ("name", "numbers", "why"),
    [
        ("encoder/other", 6, "it has no encoder/other"),
        ("encoder/weight", 5, "encoder/weight is not 5 numbers"),
        ("decoder/codes", 5, "decoder/codes is not 5 numbers"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(folder, name, numbers, why):
    with pytest.raises(NotAWhisperFile, match=why):
        adapted(folder, {name: column(np.zeros(numbers))})


@pytest.mark.parametrize("size", [0, 3, 10, 40])
def test_a_file_that_is_cut_off_is_refused(folder, size):
    held = (folder / FILE).read_bytes()
    (folder / FILE).write_bytes(held[:size])

    with pytest.raises(NotAWhisperFile, match=FILE):
        adapted(folder, {})


def test_a_file_whose_last_array_is_cut_off_is_refused(folder):
    (folder / FILE).write_bytes((folder / FILE).read_bytes()[:-6])

    with pytest.raises(NotAWhisperFile, match=FILE):
        adapted(folder, {})


def test_another_version_of_the_format_is_refused(folder):
    (folder / FILE).write_bytes(file_of(version=7))

    with pytest.raises(NotAWhisperFile, match="its format is 7, expected 6"):
        adapted(folder, {})


@pytest.mark.parametrize("bytes_more", [-4, 4])
def test_an_array_that_is_not_as_long_as_its_shape_says_is_refused(folder, bytes_more):
    whole = array("encoder/short", 0, np.zeros(3, np.float32))
    told = struct.pack("<BI", 0, 12), struct.pack("<BI", 0, 12 + bytes_more)
    values = bytes(12 + bytes_more)
    (folder / FILE).write_bytes(file_of(whole[:-12].replace(*told) + values))

    with pytest.raises(NotAWhisperFile, match="encoder/short has"):
        adapted(folder, {})


def test_a_folder_holds_the_files_as_they_were_and_the_changed_one_while_it_is_used(folder):
    (folder / ".cache").mkdir()
    added = {"encoder/weight": column(np.ones(6))}
    before = (folder / FILE).read_bytes()

    with adapted_folder(folder, added) as place:
        assert {one.name for one in place.iterdir()} == {"config.json", FILE}
        assert (place / "config.json").read_bytes() == b"{}"
        assert (place / FILE).read_bytes() == adapted(folder, added) != before

    assert not place.exists()
    assert (folder / FILE).read_bytes() == before


def test_nothing_is_left_open_or_on_the_disk_by_who_fails_to_load_it(folder):
    open_files = set(os.listdir("/proc/self/fd"))

    with pytest.raises(RuntimeError), adapted_folder(folder, {}) as place:
        raise RuntimeError("it does not fit")

    assert not place.exists()
    assert set(os.listdir("/proc/self/fd")) == open_files
