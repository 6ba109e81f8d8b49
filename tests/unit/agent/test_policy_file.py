"""A policy file is read as it was meant. Wrong ones: tests/wrong/policy."""

import json
from pathlib import Path
from typing import get_args

import pytest

from edgevox.agent.policy.guard import explain
from edgevox.agent.policy.policy import PolicyFile, Rule, WayName, parse_policy, read_policy_file
from edgevox.apps.agent.policy import known_names
from edgevox.core.commands import Way
from edgevox.robots.flat.apartment import ApartmentRobot

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "examples" / "policy" / "lobby.yaml"

WHOLE = """\
about: all there is
rules:
  "*": {grasp: confirm}
  voice: {"*": allow, navigate_xy: deny}
  cmd_vel: deny
limits:
  places: {only: [kitchen, Living_Room], never: [bathroom]}
  distance_m: 5
  speed: {linear_m_s: 0.3, angular_rad_s: 0.6}
  goals: {frame: map, x: {min: 0, max: 8}, y: {max: 6}}
  hand: {x: {min: 0.2}, z: {min: 0.05, max: 0.6}}
  hours:
    - {from: "07:30", to: "19:00", days: [mon, tue]}
    - {from: "22:00", to: "02:00"}
"""


def rules(text):
    return parse_policy(f"rules: {text}", "p.yaml")


def test_all_there_is_can_be_read_and_says_what_it_permits():
    said = explain(parse_policy(WHOLE, "whole.yaml"))
    assert said == [
        *(
            f"{way}: every skill is done, but grasp is done after a yes; navigate_xy is refused"
            for way in ["voice", "voice_guest"]
        ),
        *(
            f"{way}: every skill is done, but grasp is done after a yes"
            for way in ["typed", "text_input"]
        ),
        *(
            f"{way}: every skill is done, but grasp is refused (confirm, and nobody can be asked)"
            for way in ["command", "action", "goal_pose"]
        ),
        "cmd_vel: is refused",
        *(
            f"{way}: every skill is done, but grasp is done after a yes"
            for way in ["console_viewer", "console_operator"]
        ),
        "places: only kitchen, Living_Room; never bathroom",
        "distance: at most 5 m at a time",
        "speed of drives and cmd_vel: at most 0.3 m/s, at most 0.6 rad/s; what is faster is slowed",
        "goals of drives, map frame, metres: x from 0 to 8, y to 6",
        "points for the hand, map frame, metres: x from 0.2, z from 0.05 to 0.6",
        "hours, local time: 07:30-19:00 (mon, tue), 22:00-02:00",
    ]


def test_a_way_is_named_in_the_file_as_everywhere_else():
    assert set(get_args(WayName)) == {"*", *Way}


def test_what_no_rule_names_is_allowed():
    assert {rules("{}").rule(way, "grasp") for way in Way} == {Rule.ALLOW}


def test_one_word_stands_for_every_skill():
    assert rules("{voice: deny}").rule(Way.VOICE, "grasp") is Rule.DENY
    assert rules("{'*': deny}").rule(Way.ACTION, "grasp") is Rule.DENY


def test_a_skill_under_its_way_counts_before_all_else():
    file = rules("{'*': {'*': deny, grasp: deny}, voice: {'*': deny, grasp: allow}}")
    assert file.rule(Way.VOICE, "grasp") is Rule.ALLOW
    assert file.rule(Way.TYPED, "grasp") is Rule.DENY


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("{'*': {grasp: deny}, voice: allow}", Rule.DENY),
        ("{'*': {grasp: allow}, voice: deny}", Rule.DENY),
        ("{'*': {grasp: allow}, voice: confirm}", Rule.CONFIRM),
        ("{'*': {grasp: allow, '*': deny}, voice: allow}", Rule.ALLOW),
        ("{'*': {'*': deny}, voice: allow}", Rule.ALLOW),
        ("{'*': {'*': deny}, voice: {place: allow}}", Rule.DENY),
    ],
)
def test_of_a_ways_every_and_everybodys_skill_the_stricter_counts(text, rule):
    assert rules(text).rule(Way.VOICE, "grasp") is rule


def test_the_example_is_right_and_names_skills_and_places_that_there_are():
    file = read_policy_file(EXAMPLE)
    assert file.about
    assert file.skills <= known_names(())
    assert file.limits.places.names <= set(ApartmentRobot(speed=0.0).places)
    assert len(explain(file)) > len(Way)


def test_the_schema_in_docs_is_that_of_the_format():
    written = json.loads((ROOT / "docs" / "policy.schema.json").read_text())
    assert written == PolicyFile.model_json_schema()
