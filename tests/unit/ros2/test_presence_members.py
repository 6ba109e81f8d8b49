"""Which of several agents on one namespace moves the robot."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.errors import InvalidValue
from edgevox.core.status import Level
from edgevox.ros2.open import Sharing
from edgevox.ros2.presence import (
    GONE_BEATS,
    MOST_OTHERS,
    SETTLED_BEATS,
    Claim,
    ClaimMessage,
    Members,
    new_claim,
    read_claim,
    write_claim,
)

START_NS = 1_795_000_000_000_000_000


def claim(number: int, started_s: float = 0.0, **more: object) -> Claim:
    started_ns = START_NS + round(started_s * 1e9)
    return Claim(f"{number:08x}", "robot-apartment", "host", 100 + number, started_ns, **more)


def settled(number: int, started_s: float = 0.0) -> Members:
    """One that has been here alone for a while."""
    agent = Members(claim(number, started_s))
    for _ in range(SETTLED_BEATS):
        agent.beat()
    return agent


def meet(*agents: Members) -> None:
    """Everybody hears everybody."""
    for one in agents:
        for other in agents:
            if other is not one:
                one.hear(other.me)


def in_charge(*agents: Members) -> list[int]:
    return [int(agent.me.id, 16) for agent in agents if agent.in_charge]


def test_alone_it_is_in_charge_from_the_first_moment():
    assert Members(claim(1)).in_charge


def test_the_later_one_is_not_in_charge():
    first, second = settled(1), Members(claim(2, started_s=60))
    meet(first, second)
    assert in_charge(first, second) == [1]


def test_a_clock_that_is_behind_makes_nobody_the_first():
    first, second = settled(1), Members(claim(2, started_s=-1e9))
    meet(first, second)
    assert in_charge(first, second) == [1]


def test_who_is_told_to_take_over_is_in_charge_until_another_one_is():
    first, second = settled(1), Members(claim(2, started_s=60))
    meet(first, second)
    assert second.give("00000002")
    assert not first.give("00000002")
    meet(first, second)
    assert in_charge(first, second) == [2]
    assert first.give("00000001")
    meet(first, second)
    assert in_charge(first, second) == [1]


def test_one_that_leaves_or_is_not_heard_any_more_leaves_the_charge_to_the_other():
    first, second = settled(1), Members(claim(2, started_s=60))
    meet(first, second)
    second.hear(replace(first.me, leaving=True))
    assert second.in_charge
    meet(first, second)
    for _ in range(GONE_BEATS - 1):
        second.beat()
        assert not second.in_charge
    second.beat()
    assert second.in_charge
    assert second.others == ()


def test_one_that_was_away_for_a_while_is_first_again():
    first, second = settled(1), Members(claim(2, started_s=60))
    meet(first, second)
    for _ in range(GONE_BEATS + SETTLED_BEATS):
        second.beat()
    meet(first, second)
    assert in_charge(first, second) == [1]


def test_an_agent_without_a_robot_takes_nothing_and_cannot_be_told_to():
    talker, robot = Members(replace(claim(1), robot="")), Members(claim(2, started_s=60))
    meet(talker, robot)
    assert in_charge(talker, robot) == [2]
    assert [one.id for one in robot.others] == ["00000001"]
    with pytest.raises(InvalidValue, match="an agent that has a robot"):
        talker.give("00000001")


def test_an_id_that_nobody_has_is_refused_with_those_that_are_here():
    first, second = settled(1), Members(claim(2))
    meet(first, second)
    with pytest.raises(InvalidValue, match="one of 00000001, 00000002"):
        first.give("robot")


def test_a_flood_of_names_is_bounded_and_forgotten():
    agent = settled(1)
    for number in range(2, 10 * MOST_OTHERS):
        agent.hear(claim(number, started_s=60))
    assert len(agent.others) == MOST_OTHERS
    for _ in range(GONE_BEATS):
        agent.beat()
    assert agent.others == ()


claims = st.builds(
    claim,
    st.integers(0, 2**32 - 1),
    st.floats(-1e6, 1e6),
    term=st.integers(0, 3),
)


@given(st.lists(claims, min_size=1, max_size=5, unique_by=lambda one: one.id))
def test_all_agree_on_exactly_one_whatever_they_claim(here):
    agents = [Members(one) for one in here]
    meet(*agents)
    assert len(in_charge(*agents)) == 1


def test_a_claim_reads_as_it_was_written_and_more_fields_do_not_matter():
    mine = new_claim("robot-panda")
    told = json.loads(write_claim(ClaimMessage(mine, in_charge=True)))
    assert read_claim(json.dumps({**told, "new": 1})) == mine


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "{",
        "null",
        "x" * 5000,
        json.dumps({"id": "00000001"}),
        write_claim(ClaimMessage(replace(claim(1)), in_charge=True)).replace("00000001", "0"),
        write_claim(ClaimMessage(claim(1), in_charge=True)).replace('"term": 0', '"term": -1'),
        write_claim(ClaimMessage(claim(1), in_charge=True)).replace('"term": 0', '"term": 1e300'),
        write_claim(ClaimMessage(claim(1), in_charge=True)).replace('"term": 0', '"term": true'),
        write_claim(ClaimMessage(claim(1), in_charge=True)).replace('"host"', f'"{"h" * 300}"'),
    ],
)
def test_what_is_no_claim_is_refused(text):
    with pytest.raises(InvalidValue, match="presence"):
        read_claim(text)


@pytest.mark.parametrize(
    ("others", "yields", "level"),
    [((), False, Level.OK), (("b",), False, Level.WARN), (("b",), True, Level.ERROR)],
)
def test_the_component_is_as_bad_as_it_is(others, yields, level):
    said = Sharing("/robot1", "00000001", others, yields).status()
    assert said.level == level
    assert "/robot1" in said.message
    assert said.texts["in_charge"] == str(not yields).lower()


def test_the_component_names_the_robots_of_its_group_if_there_is_one():
    assert "group" not in Sharing("/robot1", "00000001").status().values
    said = Sharing("/robot1", "00000001", group=("Bender", "Max")).status()
    assert said.level == Level.OK
    assert said.values["group"] == "Bender, Max"
