"""A keystore for tests, and participants that use one, or none.

It needs a middleware that has DDS security: `make secured` puts one in place of the wheels'.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

import pytest
from agent_process import Agent
from peer import Peer

from edgevox.apps.security_command import main
from edgevox.security.keystore import Keystore, Purpose
from edgevox.security.roles import EnclaveRole, Graph

AGENT = "/edgevox/edgevox"
ROBOT = ("robot-apartment", "--text-mode", "--ros2", "--llm=none")


def new_keystore(folder: Path, domain: int) -> Path:
    """A keystore as the command makes it, with a robot and who is a peer of it."""
    assert main(["create", str(folder)]) == 0
    for role, path in (
        ("robot", AGENT),
        ("recorder", "/edgevox/edgevox_recorder"),
        ("tools", "/tools"),
        ("tools", "/stranger"),
        ("tools", "/friend"),
        ("listener", "/listener"),
        ("listener", "/laptop"),
    ):
        added = ["add", str(folder), role, "--enclave", path, "--domain", str(domain)]
        assert main(added) == 0
    return folder


def add_at(folder: Path, enclave: str, domain: int, when: datetime, days: int) -> None:
    """One more listener, as of another day."""
    graph = Graph("/edgevox", "robot-apartment")
    Keystore(folder).add(enclave, Purpose(EnclaveRole.LISTENER, graph, domain, days), when)


@contextmanager
def security(keystore: Path | None) -> Iterator[None]:
    """The environment of whoever uses this keystore, or none."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_SECURITY_ENABLE", "true" if keystore else "false")
        patch.setenv("ROS_SECURITY_STRATEGY", "Enforce")
        patch.setenv("ROS_SECURITY_KEYSTORE", str(keystore or ""))
        patch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
        yield


def secured_peer(domain: int, keystore: Path, enclave: str) -> Peer:
    """A peer that is called as its enclave."""
    with security(keystore):
        return Peer(domain, name=enclave[1:], args=["--ros-args", "--enclave", enclave])


def open_peer(domain: int, name: str) -> Peer:
    """A peer without security."""
    with security(None):
        return Peer(domain, name=name)


def secured_process(domain: int, keystore: Path, enclave: str, *arguments: str, **options) -> Agent:
    """A program of ours in an enclave."""
    with security(keystore):
        given = (*arguments, "--ros-args", "--enclave", enclave)
        return Agent(*given, domain=domain, **options)
