"""Probes of ROS 2 for `edgevox doctor` and for the start-up, each run in its own process.

``python -m edgevox.ros2.doctor TOPIC`` is the other end of the round trip: it sends back every
message that it hears.
"""

import importlib
import importlib.util
import os
import re
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

from edgevox.ros2.open import check_environment, installed_middlewares

INTERFACES = ("edgevox_msgs.action", "edgevox_msgs.msg", "tf2_msgs.msg", "diagnostic_msgs.msg")
TRY_S = 10.0
GRAPH_S = 3.0
"""Until other nodes are known."""
EVERY_S = 0.05
TRIPS = 5


def middleware() -> dict[str, Any]:
    """Report whether rclpy is installed and the environment's middleware loads."""
    facts = {"missing": "", "failed": "", "middleware": "", "installed": installed_middlewares()}
    if importlib.util.find_spec("rclpy") is None:
        return facts | {"missing": "no module rclpy"}
    try:
        check_environment(os.environ)
        from rclpy.context import Context
        from rclpy.utilities import get_rmw_implementation_identifier

        context = Context()
        context.init()
        context.try_shutdown()
        return facts | {"middleware": get_rmw_implementation_identifier()}
    except Exception as error:  # noqa: BLE001 - whatever it is, it is what is asked for
        return facts | {"failed": " ".join(str(error).split()) or repr(error)}


def interfaces() -> dict[str, Any]:
    """List the interfaces of EdgeVox that are not built for this Python."""
    return {"missing": [name for name in INTERFACES if not _imports(name)]}


def graph() -> dict[str, Any]:
    """The nodes, and the types and ends of each topic, on the domain of the environment."""
    with _Node("edgevox_doctor") as node:
        time.sleep(GRAPH_S)
        topics = {
            name: {
                "types": types,
                "publishers": len(node.get_publishers_info_by_topic(name)),
                "subscriptions": len(node.get_subscriptions_info_by_topic(name)),
            }
            for name, types in node.get_topic_names_and_types()
        }
        nodes = sorted(f"{within.rstrip('/')}/{name}" for name, within in _nodes(node))
        return {"nodes": nodes, "topics": topics}


def _nodes(node: Any) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = node.get_node_names_and_namespaces()
    return found


def round_trip() -> dict[str, Any]:
    """A message to a node of another process and back: when it came, and how long one takes.

    On the domain and with all settings of the environment, since those are in question.
    """
    from rclpy.qos import QoSProfile
    from std_msgs.msg import String

    topic = f"/edgevox_doctor/p{os.getpid()}"
    command = [sys.executable, "-m", "edgevox.ros2.doctor", topic]
    other = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        if other.stdout:
            other.stdout.readline()  # it is there, however long that took
        began_s = time.monotonic()
        with _Node("edgevox_doctor") as node:
            back = threading.Event()
            node.create_subscription(
                String, f"{topic}/back", lambda _: back.set(), QoSProfile(depth=1)
            )
            there = node.create_publisher(String, f"{topic}/there", QoSProfile(depth=1))
            met_s = _until_heard(lambda: there.publish(String()), back, began_s)
            trip_ms = None if met_s is None else _fastest_ms(lambda: there.publish(String()), back)
    finally:
        other.communicate()  # the end of its input ends it in good order
    return {"met_s": met_s, "trip_ms": trip_ms, "tried_s": TRY_S}


def echo(topic: str) -> None:
    """Write a line when ready; then send back every message, until standard input ends."""
    from rclpy.qos import QoSProfile
    from std_msgs.msg import String

    with _Node("edgevox_doctor_echo") as node:
        back = node.create_publisher(String, f"{topic}/back", QoSProfile(depth=1))
        node.create_subscription(String, f"{topic}/there", back.publish, QoSProfile(depth=1))
        sys.stdout.write("there\n")  # noqa: TID251 - to its parent
        sys.stdout.flush()
        sys.stdin.read()


class _Node:
    """A plain node, spun by a thread while entered."""

    def __init__(self, name: str) -> None:
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.node import Node

        self._context = Context()
        self._context.init()
        self._node = Node(name, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=name)

    def __enter__(self) -> Any:
        self._thread.start()
        return self._node

    def __exit__(self, *_: object) -> None:
        from edgevox.ros2.node import end_spin

        end_spin(self._ended, self._executor, self._thread)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _spin(self) -> None:
        from rclpy.executors import ExternalShutdownException

        from edgevox.ros2.node import spin_until

        try:
            spin_until(self._ended, self._executor)
        except ExternalShutdownException:
            return


def _until_heard(send: Any, back: threading.Event, began_s: float) -> float | None:
    """Seconds from the beginning to the first answer; None if there was none."""
    while time.monotonic() - began_s < TRY_S:
        send()
        if back.wait(EVERY_S):
            return time.monotonic() - began_s
    return None


def _fastest_ms(send: Any, back: threading.Event) -> float | None:
    """The fastest of some trips; None if no other came."""
    fastest_s = None
    for _ in range(TRIPS):
        time.sleep(EVERY_S)  # what was sent before has come back by now
        back.clear()
        sent_s = time.monotonic()
        send()
        if back.wait(1.0):
            took_s = time.monotonic() - sent_s
            fastest_s = took_s if fastest_s is None else min(fastest_s, took_s)
    return None if fastest_s is None else fastest_s * 1000.0


def _imports(name: str) -> bool:
    try:
        importlib.import_module(name)
    except ImportError:
        return False
    return True


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


_NO_PARTICIPANT = "create participant"
"""Part of rmw's message if the enclave is at fault, and not the node's name."""


def participant_probe() -> dict[str, Any]:
    """Try to create a participant in the environment's enclave, and leave at once.

    Only the middleware can check who signed the governance and the permissions.
    """
    import rclpy
    from rclpy.context import Context

    context = Context()
    try:
        context.init()
        rclpy.create_node("edgevox_enclave_check", context=context).destroy_node()
    except Exception as failed:  # noqa: BLE001 - rclpy has no base class for what it raises
        return {"taken": _NO_PARTICIPANT not in str(failed)}
    finally:
        context.try_shutdown()
    return {"taken": True}


if __name__ == "__main__":
    echo(sys.argv[1])
