"""Whether the middleware has DDS security is told as its own headers tell it, without a node."""

import os
import re
import sys
from pathlib import Path

import pytest

from edgevox.core.probe import probe_apart
from edgevox.ros2.doctor import middleware_build

PROBE = f"{middleware_build.__module__}:{middleware_build.__name__}"


def _has_security() -> bool:
    """What Fast DDS was built with, by the header that its packages install."""
    prefixes = [*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix]
    headers = [one for p in prefixes if p for one in Path(p, "include").rglob("fastrtps/config.h")]
    return re.search(r"#define HAVE_SECURITY 1", headers[0].read_text()) is not None


@pytest.mark.parametrize("asked", [(), ("rmw_fastrtps_cpp",)])
def test_it_is_what_the_headers_say_even_where_security_is_asked_for(asked, monkeypatch):
    """A context of ROS 2 would look for the enclave, and there is none."""
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    monkeypatch.setenv("ROS_SECURITY_STRATEGY", "Enforce")
    monkeypatch.setenv("ROS_SECURITY_KEYSTORE", "/nowhere")
    facts = probe_apart(PROBE, *asked)
    assert (facts["middleware"], facts["security"]) == ("rmw_fastrtps_cpp", _has_security())
