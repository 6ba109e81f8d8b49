"""The skill that takes a picture, and the folder that keeps the newest ones."""

from datetime import UTC, datetime, timedelta
from io import BytesIO
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.robots.capabilities import CameraImage
from edgevox.robots.facts import facts_of
from edgevox.robots.pictures import Album, picture_skills

PIXELS = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)


class Eye:
    """A body with a camera of its own."""

    name, skills = "eye", ()
    camera_spec = None

    def camera(self):
        return CameraImage(0.0, PIXELS)


class Ear:
    """A body that hears the pictures of a camera."""

    name, skills = "ear", ()

    def __init__(self, newest=PIXELS):
        self.newest = newest

    def newest_picture(self):
        if isinstance(self.newest, Exception):
            raise self.newest
        return self.newest


def today():
    seconds = count()
    return lambda: datetime(2026, 11, 29, tzinfo=UTC) + timedelta(seconds=next(seconds))


def take(body, folder, taken):
    (one,) = picture_skills(body, Album(folder, 1_000_000, today()), taken.append)
    assert not one.moves
    return one.function(SimpleNamespace(token=CancelToken()))


@pytest.mark.parametrize("body", [Eye(), Ear()])
def test_a_picture_is_kept_as_a_png_and_told(tmp_path, body):
    folder, taken = tmp_path / "new" / "pictures", []

    told = take(body, folder, taken)

    (file,) = folder.iterdir()
    assert told == {"folder": "pictures", "file": str(file)}
    assert file.name == "picture-20261129-000000-000000.png"
    assert np.array_equal(np.asarray(Image.open(file)), PIXELS)
    assert [(one.png, one.file) for one in taken] == [(file.read_bytes(), str(file))]


@pytest.mark.parametrize("newest", [None, InvalidValue("encoding", "16UC1", "rgb8")])
def test_a_camera_that_gives_nothing_is_a_reason_that_is_said(tmp_path, newest):
    taken = []

    with pytest.raises(SkillFailed) as failed:
        take(Ear(newest), tmp_path, taken)

    assert failed.value.reason.code == "no_picture"
    assert not taken
    assert not list(tmp_path.iterdir())


def test_a_picture_that_cannot_be_kept_is_told_and_said_to_be_lost(tmp_path):
    (tmp_path / "pictures").write_text("a file in the folder's place")
    taken = []

    with pytest.raises(SkillFailed) as failed:
        take(Eye(), tmp_path / "pictures", taken)

    assert failed.value.reason.code == "picture_not_kept"
    (one,) = taken
    assert one.file == ""
    assert np.array_equal(np.asarray(Image.open(BytesIO(one.png))), PIXELS)


def test_the_oldest_pictures_go_for_new_ones_and_other_files_stay(tmp_path):
    album = Album(tmp_path, 250, today())
    (tmp_path / "notes.txt").write_text("x" * 1000)
    (tmp_path / ".picture-20251231-000000-000000.png.partial").write_bytes(b"left by a kill")

    files = [album.keep(b"x" * 100) for _ in range(4)]

    kept = sorted(one.name for one in tmp_path.iterdir())
    assert kept == ["notes.txt", files[2].name, files[3].name]


def test_one_picture_is_kept_however_large_it_is(tmp_path):
    album = Album(tmp_path, 10, today())

    album.keep(b"x" * 100)
    newest = album.keep(b"y" * 100)

    assert list(tmp_path.iterdir()) == [newest]


def test_a_body_without_a_camera_has_no_such_skill_and_says_so(tmp_path):
    blind = SimpleNamespace(name="blind", skills=())

    assert picture_skills(blind, Album(tmp_path, 1), print) == ()
    assert "take_picture" in [one.name for one in facts_of(blind)]
    assert "take_picture" not in [one.name for one in facts_of(Eye())]
