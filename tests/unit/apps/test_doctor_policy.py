"""The doctor says what a policy permits, a line at a time; a broken file is an error."""

from doctor_rig import ERROR, OK, WARNING, levels, situation

from edgevox.agent.policy.guard import NO_FILE
from edgevox.apps.doctor.robots import judge_policy, probe_policy


def told(tmp_path, text, agent=""):
    """The verdicts on a policy of this text."""
    file = tmp_path / "policy.yaml"
    if text is not None:
        file.write_text(text)
    asked = situation(agent, policy=str(file))
    said = judge_policy(probe_policy(asked), asked)
    return said if isinstance(said, list) else [said]


def test_without_a_file_it_says_that_nothing_is_forbidden():
    asked = situation()
    said = judge_policy(probe_policy(asked), asked)
    assert said.level is OK
    assert NO_FILE in said.found


def test_each_rule_and_limit_is_a_line_and_so_is_whether_it_may_move_now(tmp_path):
    hours = "hours: [{from: '00:00', to: '24:00'}]"
    said = told(tmp_path, f"rules: {{voice: deny}}\nlimits: {{distance_m: 3, {hours}}}")
    lines = [one.found for one in said]
    assert set(levels(said)) == {OK}
    assert "voice: every skill is refused" in lines
    assert "distance: at most 3 m at a time" in lines
    assert lines[-1].endswith("it may move")


def test_a_broken_file_is_an_error_with_its_line(tmp_path):
    (said,) = told(tmp_path, "rules:\n  voice: {grasp: perhaps}\n")
    assert said.level is ERROR
    assert "policy.yaml:2: rules.voice.grasp: got 'perhaps'" in said.found


def test_a_missing_file_is_an_error(tmp_path):
    (said,) = told(tmp_path, None)
    assert said.level is ERROR
    assert "a file that can be read" in said.found


def test_a_skill_that_no_robot_has_is_a_warning(tmp_path):
    said = told(tmp_path, "rules: {voice: {grap: deny, grasp: deny, mute: deny}}")
    assert [one.found for one in said if one.level is WARNING] == [
        "grap: no such skill; did you mean grasp?"
    ]


def test_a_place_that_the_robot_has_not_is_a_warning_with_the_nearest(tmp_path):
    text = "limits: {places: {never: [Bed_Rom, Bed_Room, Schlafzimmer], only: [Küchen, moon]}}"
    said = told(tmp_path, text, agent="robot-apartment")
    assert [one.found for one in said if one.level is WARNING] == [
        "Bed_Rom: no such place; did you mean bedroom?",
        "moon: no such place",
    ]
