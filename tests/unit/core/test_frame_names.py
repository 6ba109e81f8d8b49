"""What the settings take as a prefix of frames is what /tf is given, and looking takes no time."""

import pytest

from edgevox.core.errors import InvalidValue
from edgevox.core.settings import load_settings
from edgevox.core.transforms import is_prefix
from edgevox.ros2.interop.frames import Frames

GOOD = ["", "robot1/", "robot_1", "fleet/robot1/", "r/_1/"]
BAD = ["/", "/robot1", "1/", "_robot/", "a//b", "a/1", "a b/", "a\n", "a/é", "a" * 100 + "!"]


@pytest.mark.parametrize("prefix", GOOD)
def test_a_good_prefix_is_taken_by_both(prefix) -> None:
    assert is_prefix(prefix)
    assert load_settings({"frame_prefix": prefix}).frame_prefix == prefix
    assert Frames(prefix=prefix).base == f"{prefix}base_link"


@pytest.mark.parametrize("prefix", BAD)
def test_another_is_refused_by_both_with_what_would_be_right(prefix) -> None:
    for ask in (lambda: load_settings({"frame_prefix": prefix}), lambda: Frames(prefix=prefix)):
        with pytest.raises(InvalidValue, match=r"frame_prefix: got .*a prefix such as robot1/"):
            ask()
