"""What is added to Whisper: for one model alone, and how much of a sound is listened to then."""

from importlib.resources import files

import numpy as np
import pytest

from edgevox.voice.stt import adapter, whisper
from edgevox.voice.stt.adapter import FILE, adapter_for


def test_a_model_that_it_was_not_made_for_stays_as_it_is(tmp_path):
    (tmp_path / FILE).write_bytes(b"some other model")

    assert adapter_for(tmp_path) == {}


def test_nor_does_one_that_is_as_long_as_its_own(tmp_path):
    with np.load(files("edgevox.voice.stt").joinpath(adapter.ADAPTER_FILE)) as data:
        size = int(data[adapter.SIZE])
    with (tmp_path / FILE).open("wb") as held:
        held.truncate(size)

    assert adapter_for(tmp_path) == {}


def test_a_model_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        adapter_for(tmp_path)


@pytest.mark.parametrize(
    ("rows", "short", "listened_to"),
    [
        (0, True, whisper.FEWEST_ROWS),
        (96, True, whisper.FEWEST_ROWS),
        (250, True, 250 + whisper.ROWS_AFTER),
        (251, True, 252 + whisper.ROWS_AFTER),
        (900, True, 900 + whisper.ROWS_AFTER),
        (901, True, 3_000),
        (3_500, True, 3_000),
        (150, False, 3_000),
        (3_500, False, 3_000),
    ],
)
def test_with_it_little_more_is_listened_to_than_was_said(rows, short, listened_to):
    heard = np.ones((80, rows), np.float32)

    found = whisper.as_listened_to(heard, short)

    assert found.shape == (80, listened_to)
    assert found.sum() == 80 * min(rows, 3_000)
