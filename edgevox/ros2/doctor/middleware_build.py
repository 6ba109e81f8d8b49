"""The middleware's build: security, and whose OpenSSL. Runs in its own process."""

import importlib.util
import os
import re
from pathlib import Path
from typing import Any

SECURITY = b"dds.sec.auth.builtin.PKI-DH"
"""A property of Fast DDS's authentication plug-in: a build without security lacks its name."""
FAST_DDS = re.compile(r"libfast(rtps|dds)\.so")
BUNDLED_OPENSSL = re.compile(r"\.libs/libssl-\w+\.so\.([\w.]+)")
"""OpenSSL libraries of Python wheels: their folder and file names are unlike any other's."""


def middleware_build(middleware: str = "") -> dict[str, Any]:
    """Report which middleware loads, whether it has DDS security, and the wheels' OpenSSL version.

    Makes no node: without security support, one would hang or end the process. Only Fast DDS counts
    as secure, since only its libraries are known here.
    """
    for name in [name for name in os.environ if name.startswith("ROS_SECURITY_")]:
        del os.environ[name]  # a context would look for the enclave first
    if middleware:
        os.environ["RMW_IMPLEMENTATION"] = middleware
    if importlib.util.find_spec("rclpy") is None:
        return {"middleware": "", "security": False, "bundled_openssl": ""}
    from rclpy.context import Context
    from rclpy.utilities import get_rmw_implementation_identifier

    context = Context()
    context.init()
    context.try_shutdown()
    maps = Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace")
    loaded = {line.split(maxsplit=5)[5] for line in maps.splitlines() if ".so" in line}
    return {"middleware": get_rmw_implementation_identifier(), **judged_by(loaded)}


def judged_by(libraries: set[str]) -> dict[str, Any]:
    """Judge the build by the paths of the loaded libraries."""
    fast_dds = [Path(one) for one in libraries if FAST_DDS.search(one)]
    openssl = [found[1] for one in libraries if (found := BUNDLED_OPENSSL.search(one))]
    return {
        "security": any(SECURITY in one.read_bytes() for one in fast_dds),
        "bundled_openssl": max(openssl, default=""),
    }
