"""The pictures of a robot's own camera, as its driver sends them."""

import io

import numpy as np
import pytest
from PIL import Image as Pillow
from sensor_msgs.msg import CompressedImage, Image

from edgevox.core.errors import InvalidValue
from edgevox.ros2.external.sensors import pixels_of, unpacked

RED, BLUE = (200, 10, 20), (30, 40, 250)


def image(encoding: str, pixels: np.ndarray, padding: int = 0) -> Image:
    rows = pixels.reshape(len(pixels), -1).astype(np.uint8)
    rows = np.pad(rows, ((0, 0), (0, padding)))
    height, width = pixels.shape[:2]
    return Image(
        encoding=encoding, height=height, width=width, step=rows.shape[1], data=rows.tobytes()
    )


@pytest.mark.parametrize(
    ("encoding", "order"),
    [
        ("rgb8", (0, 1, 2)),
        ("bgr8", (2, 1, 0)),
        ("8UC3", (2, 1, 0)),
        ("rgba8", (0, 1, 2, 0)),
        ("bgra8", (2, 1, 0, 0)),
    ],
)
@pytest.mark.parametrize("padding", [0, 5])
def test_colours_are_what_they_were(encoding: str, order: tuple[int, ...], padding: int) -> None:
    seen = np.array([[RED, BLUE, RED], [BLUE, RED, BLUE]], np.uint8)
    assert (pixels_of(image(encoding, seen[:, :, order], padding)) == seen).all()


def test_grey_is_grey() -> None:
    grey = np.array([[1, 2], [3, 4]], np.uint8)
    assert (pixels_of(image("mono8", grey)) == grey[:, :, None]).all()


@pytest.mark.parametrize(
    ("changed", "field"),
    [
        ({"encoding": "16UC1"}, "encoding"),
        ({"encoding": ""}, "encoding"),
        ({"step": 1}, "step"),
        ({"height": 0}, "step"),
        ({"height": 4}, "data"),
        ({"width": 2**31}, "step"),
    ],
)
def test_what_cannot_be_a_picture_is_refused_by_field(changed: dict, field: str) -> None:
    message = image("rgb8", np.zeros((2, 3, 3)))
    for name, value in changed.items():
        setattr(message, name, value)
    with pytest.raises(InvalidValue) as refused:
        pixels_of(message)
    assert refused.value.field == f"camera/image_raw: {field}"


@pytest.mark.parametrize("kind", ["PNG", "WEBP"])
def test_a_compressed_picture_has_its_colours(kind: str) -> None:
    pixels = np.array([[RED, BLUE, RED], [BLUE, RED, BLUE]], np.uint8)
    file = io.BytesIO()
    Pillow.fromarray(pixels).save(file, kind, lossless=True)

    assert (unpacked(CompressedImage(data=file.getvalue())) == pixels).all()


def test_a_compressed_picture_that_is_cut_or_of_depth_is_refused_by_its_format() -> None:
    file = io.BytesIO()
    Pillow.fromarray(np.zeros((64, 64, 3), np.uint8)).save(file, "JPEG")
    depth = b"\0" * 12 + file.getvalue()
    for data in (file.getvalue()[:-200], depth, b""):
        with pytest.raises(InvalidValue) as refused:
            unpacked(CompressedImage(format="16UC1; compressedDepth png", data=data))
        assert refused.value.field == "camera/image_raw: format"
        assert refused.value.value == "16UC1; compressedDepth png"
