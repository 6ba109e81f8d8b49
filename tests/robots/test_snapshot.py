"""`edgevox-agent ROBOT --snapshot FILE` and `/picture`."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from guards import HUNG_S
from PIL import Image

from edgevox.core.errors import InvalidValue
from edgevox.robots.pictures import write_picture

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))


class Painting:
    """A body that looks like this."""

    def __init__(self, pixels):
        self.pixels = pixels

    def picture(self):
        return self.pixels


def snapshot(*arguments):
    return subprocess.run([AGENT, *arguments], capture_output=True, text=True, timeout=HUNG_S)


def test_a_snapshot_is_the_bodys_picture_and_nothing_else_is_written(tmp_path):
    pixels = np.random.default_rng(1).integers(0, 256, (30, 40, 3), dtype=np.uint8)
    file = tmp_path / "robot.png"
    file.write_text("an older one")
    write_picture(Painting(pixels), file)
    with Image.open(file) as image:
        assert image.format == "PNG"
        assert (np.asarray(image) == pixels).all()
    assert list(tmp_path.iterdir()) == [file]


def test_a_picture_that_cannot_be_drawn_leaves_the_file_as_it_was(tmp_path):
    file = tmp_path / "robot.png"
    file.write_text("an older one")
    with pytest.raises(TypeError):
        write_picture(Painting(np.zeros((2, 2, 7), np.uint8)), file)
    assert file.read_text() == "an older one"
    assert list(tmp_path.iterdir()) == [file]


def test_a_folder_is_no_file_for_a_picture(tmp_path):
    with pytest.raises(InvalidValue, match="snapshot: got .*expected a file"):
        write_picture(Painting(np.zeros((2, 2, 3), np.uint8)), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_the_robot_is_drawn_and_the_program_ends(tmp_path):
    file = tmp_path / "robot.png"
    done = snapshot("robot-apartment", "--snapshot", str(file))
    assert (done.returncode, done.stderr) == (0, "")
    with Image.open(file) as image:
        assert len(image.convert("RGB").getcolors(1 << 24)) > 20


@pytest.mark.parametrize(
    ("robot", "file", "said"),
    [
        ("robot-apartment", "nowhere/robot.png", "expected a file in a folder that can be written"),
        ("robot-external", "robot.png", "expected a robot that can show itself"),
    ],
)
def test_what_cannot_be_drawn_ends_with_2_and_the_reason(tmp_path, robot, file, said):
    done = snapshot(robot, "--snapshot", str(tmp_path / file))
    assert done.returncode == 2
    assert said in done.stderr
    assert list(tmp_path.iterdir()) == []
