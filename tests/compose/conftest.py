"""What tests of containers need: an engine that answers, the image, nothing of this site."""

import os
import subprocess

import pytest
from guards import HUNG_S

IMAGE = "EDGEVOX_IMAGE"
OF_A_SITE = ("COMPOSE_", "EDGEVOX_", "FASTDDS_", "RMW_", "ROS_")
"""Variables that compose would pass on to the containers, or be led astray by."""


@pytest.fixture(scope="module", autouse=True)
def _no_site():
    """Only for the tests of this folder: others of this process need what is set."""
    with pytest.MonkeyPatch.context() as patch:
        for name in list(os.environ):
            if name.startswith(OF_A_SITE) and name != IMAGE:
                patch.delenv(name)
        patch.setenv("TESTCONTAINERS_RYUK_DISABLED", "true")
        yield


@pytest.fixture(scope="session")
def image():
    """The image's name; without it there is nothing to test, and that is a failure."""
    name = os.environ.get(IMAGE, "edgevox-ros2:local")
    _must(["docker", "version"], "no engine answers: start Docker, or run sudo .ci/engine")
    _must(["docker", "image", "inspect", name], f"there is no image {name}: run make image")
    return name


def _must(command: list[str], otherwise: str) -> None:
    try:
        subprocess.run(command, capture_output=True, text=True, check=True, timeout=HUNG_S)
    except (OSError, subprocess.SubprocessError) as error:
        said = getattr(error, "stderr", "") or str(error)
        pytest.fail(f"{otherwise}\n{said}", pytrace=False)
