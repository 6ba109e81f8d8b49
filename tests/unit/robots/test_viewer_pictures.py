"""How the viewer's window cuts its input into pictures."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.robots.flat.viewer import as_ppm, has_display
from edgevox.robots.flat.viewer_window import Pictures


def painted(shade: int, width: int = 5, height: int = 3) -> np.ndarray:
    return np.full((height, width, 3), shade, dtype=np.uint8)


@given(st.lists(st.integers(0, 255), max_size=5), st.integers(1, 40))
def test_pictures_come_out_whole_however_the_stream_is_cut(shades, piece) -> None:
    stream = b"".join(as_ppm(painted(shade)) for shade in shades)
    pictures = Pictures()

    seen = [pictures.add(stream[i : i + piece]) for i in range(0, len(stream), piece)]

    assert [one for one in seen if one] == [as_ppm(painted(shade)) for shade in shades]


def test_of_several_pictures_at_once_the_last_is_shown() -> None:
    stream = as_ppm(painted(1)) + as_ppm(painted(2, 7, 2)) + as_ppm(painted(3))[:-1]

    assert Pictures().add(stream) == as_ppm(painted(2, 7, 2))


@pytest.mark.parametrize("junk", [b"hello\n", b"P6 5 3 255 P6 5 3 255 ", b"x" * 100])
def test_what_is_no_picture_is_refused(junk) -> None:
    with pytest.raises(ValueError, match="not a picture"):
        Pictures().add(junk)


def test_a_picture_keeps_its_rows_and_colours_also_if_it_is_a_view() -> None:
    pixels = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)[:, ::-1]

    assert as_ppm(pixels) == b"P6 4 2 255\n" + bytes(pixels.flatten())


@pytest.mark.parametrize(
    ("environment", "there"),
    [
        ({}, False),
        ({"DISPLAY": ""}, False),
        ({"DISPLAY": ":0"}, True),
        ({"WAYLAND_DISPLAY": "w"}, True),
    ],
)
def test_a_display_is_what_the_environment_names(environment, there) -> None:
    assert has_display(environment) is there
