"""A peer without an address must not keep a robot from starting, nor hold it up for long."""

import os
import socket
import subprocess
import sys
from threading import Event

import pytest

from edgevox.apps.container import ENVIRONMENT
from edgevox.apps.container.peers import address_of, addresses, with_addresses

KNOWN = {"robot1": "10.0.0.1", "robot2": "10.0.0.2"}
NOT_THERE = "nobody.invalid"


def _with(peers, look_up=KNOWN.get, wait_s="0"):
    said = []
    given = {"PATH": "/bin", "ROS_STATIC_PEERS": peers, "EDGEVOX_PEERS_WAIT_S": wait_s}
    made = with_addresses(given, said.append, look_up)
    assert made["PATH"] == "/bin"
    return made.get("ROS_STATIC_PEERS"), said


def test_names_become_addresses_in_their_order_so_that_a_node_looks_up_nothing():
    assert _with("robot2;robot1;robot2") == ("10.0.0.2;10.0.0.1;10.0.0.2", [])


def test_who_has_no_address_is_left_out_and_named_in_one_line():
    peers, (line,) = _with("gone;robot1;lost")
    assert peers == "10.0.0.1"
    assert line.startswith("ROS_STATIC_PEERS: left out after 0 s, for there is no address of gone,")
    assert "lost;" in line


def test_with_nobody_left_there_is_no_list_and_without_a_list_nothing_is_asked():
    assert _with("gone")[0] is None
    said = []
    assert with_addresses({"A": "b"}, said.append, pytest.fail) == {"A": "b"}
    assert not said


def test_a_name_that_comes_while_it_waits_is_taken():
    asked = []

    def at_the_second_time(name):
        asked.append(name)
        return "10.0.0.3" if len(asked) > 1 else None

    assert _with("late", at_the_second_time, "60") == ("10.0.0.3", [])
    assert asked == ["late", "late"]


def test_a_server_of_names_that_never_answers_holds_up_neither_others_nor_the_start():
    answer = Event()
    try:
        found = addresses(["robot1", "stuck"], 0, lambda n: KNOWN.get(n) or str(answer.wait()))
        assert found == {"robot1": "10.0.0.1"}
    finally:
        answer.set()


@pytest.mark.parametrize(
    ("host", "address"),
    [("127.0.0.1", "127.0.0.1"), ("::1", "::1"), (NOT_THERE, None), ("a..b", None), (".", None)],
)
def test_an_address_is_what_a_node_would_take(host, address):
    assert address_of(host) == address


def test_ipv4_comes_before_ipv6_as_a_node_has_it(monkeypatch):
    both = [(socket.AF_INET6, 2, 17, "", ("fd00::1", 0, 0, 0))]
    both += [(socket.AF_INET, 2, 17, "", (f"10.0.0.{one}", 0)) for one in (1, 2)]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: both)
    assert address_of("x") == "10.0.0.1"


def test_it_waits_for_a_while_unless_told_otherwise_and_never_for_long():
    row = ENVIRONMENT["EDGEVOX_PEERS_WAIT_S"]
    assert (row.default, row.least, row.most) == ("10", 0, 60)


def test_the_entrypoint_starts_its_program_with_those_that_are_there():
    asked = "import os; print(os.environ['ROS_STATIC_PEERS'])"
    ran = subprocess.run(
        [sys.executable, "-m", "edgevox.apps.container.start", sys.executable, "-c", asked],
        env={
            "PATH": os.environ["PATH"],
            "ROS_STATIC_PEERS": f"{NOT_THERE};127.0.0.1",
            "EDGEVOX_PEERS_WAIT_S": "0",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert ran.stdout == "127.0.0.1\n"
    assert ran.stderr.count("\n") == 1
    assert NOT_THERE in ran.stderr
