"""A discovery server without an address must not take the others away, nor their places."""

import os
import subprocess
import sys

import pytest

from edgevox.apps.container import peers
from edgevox.apps.container.peers import server_names, with_server_addresses

KNOWN = {"one": "10.0.0.1", "two": "10.0.0.2", "six": "fd00::6", "10.0.0.9": "10.0.0.9"}
KNOWN |= {"fd00::9": "fd00::9"}


def _with(servers, look_up=KNOWN.get):
    said = []
    given = {"PATH": "/bin", "ROS_DISCOVERY_SERVER": servers, "EDGEVOX_PEERS_WAIT_S": "0"}
    made = with_server_addresses(given, said.append, look_up)
    assert made["PATH"] == "/bin"
    return made["ROS_DISCOVERY_SERVER"], said


@pytest.mark.parametrize(
    ("servers", "addresses"),
    [
        ("one:11811;two:11812", "10.0.0.1:11811;10.0.0.2:11812"),
        ("one", "10.0.0.1"),
        (";;two:11811;", ";;10.0.0.2:11811;"),
        ("six:11811", "[fd00::6]:11811"),
        ("[fd00::9]:11811;10.0.0.9:1", "[fd00::9]:11811;10.0.0.9:1"),
        ("TCPv4:[one]:42100", "TCPv4:[10.0.0.1]:42100"),
    ],
)
def test_names_become_addresses_whatever_else_is_said(servers, addresses):
    assert _with(servers) == (addresses, [])


@pytest.mark.parametrize(
    ("servers", "addresses"),
    [
        ("gone:11811;two:11811", ";10.0.0.2:11811"),
        ("one:11811;gone:11811", "10.0.0.1:11811;"),
        ("one:11811;gone:11811;gone:11812;two:1", "10.0.0.1:11811;;;10.0.0.2:1"),
    ],
)
def test_who_has_no_address_leaves_its_place_since_that_is_a_servers_number(servers, addresses):
    placed, (line,) = _with(servers)
    assert placed == addresses
    assert line.startswith("ROS_DISCOVERY_SERVER: left out after 0 s, for there is no address of")
    assert " gone;" in line


def test_without_any_server_it_waits_says_so_and_goes_on_with_the_first_that_comes(monkeypatch):
    monkeypatch.setattr(peers, "ROUND_S", 0)
    rounds, said = [], []

    def at_last(name):
        rounds.append(name)
        return "10.0.0.1" if name == "one" and rounds.count("one") > 14 else None

    given = {"ROS_DISCOVERY_SERVER": "gone:1;one:2", "EDGEVOX_PEERS_WAIT_S": "0"}
    made = with_server_addresses(given, said.append, at_last)
    assert made["ROS_DISCOVERY_SERVER"] == ";10.0.0.1:2"
    *waiting, left_out = said
    assert len(waiting) == 3  # in the first, the seventh and the thirteenth round
    assert set(waiting) == {
        "ROS_DISCOVERY_SERVER: there is no address of gone, one; it waits until there is one"
    }
    assert "no address of gone;" in left_out


@pytest.mark.parametrize("servers", [{}, {"ROS_DISCOVERY_SERVER": ";;"}])
def test_without_a_list_nothing_is_asked(servers):
    assert with_server_addresses(servers, pytest.fail, pytest.fail) == servers


def test_the_names_in_a_list_are_found_in_whatever_form_they_stand():
    servers = ";one:11811;[fd00::9]:1;TCPv4:[two]:42100;10.0.0.9"
    assert server_names(servers) == ["one", "fd00::9", "two", "10.0.0.9"]


def test_the_entrypoint_starts_its_program_with_the_server_that_is_there():
    asked = "import os; print(os.environ['ROS_DISCOVERY_SERVER'])"
    ran = subprocess.run(
        [sys.executable, "-m", "edgevox.apps.container.start", sys.executable, "-c", asked],
        env={
            "PATH": os.environ["PATH"],
            "ROS_DISCOVERY_SERVER": "nobody.invalid:11811;127.0.0.1:11812",
            "EDGEVOX_PEERS_WAIT_S": "0",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert ran.stdout == ";127.0.0.1:11812\n"
    assert ran.stderr.count("\n") == 1
    assert "nobody.invalid" in ran.stderr
