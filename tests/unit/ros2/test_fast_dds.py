"""Which profile of the middleware a node is made with."""

import re

import pytest

from edgevox.ros2.node import PROFILE, choose_profile

READ = "FASTRTPS_DEFAULT_PROFILES_FILE"


@pytest.mark.parametrize(
    "transports", [{}, *({"FASTDDS_BUILTIN_TRANSPORTS": t} for t in ("", "DEFAULT", "UDPv4"))]
)
def test_by_itself_it_is_ours(transports):
    environment = dict(transports)
    choose_profile(environment)
    assert environment[READ] == str(PROFILE)


@pytest.mark.parametrize(
    "given", ["FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"]
)
def test_one_that_somebody_gave_is_used_by_either_name(given):
    environment = {given: "/theirs.xml"}
    choose_profile(environment)
    assert environment[READ] == "/theirs.xml"


@pytest.mark.parametrize("transports", ["SHM", "UDPv6", "LARGE_DATA", "NONE"])
def test_transports_without_plain_udp_are_left_as_they_were_chosen(transports):
    environment = {"FASTDDS_BUILTIN_TRANSPORTS": transports}
    choose_profile(environment)
    assert READ not in environment


def test_our_profile_asks_to_be_written_to_by_udp_alone():
    text = PROFILE.read_text(encoding="utf-8")
    assert re.findall(r"<locator><(\w+)>", text) == ["udpv4"]
