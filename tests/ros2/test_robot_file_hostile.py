"""Robot files of somebody who means harm, or errs: refused soon, by name, and never run."""

import pytest

from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.ros2.external import EXTERNAL
from edgevox.ros2.robot_file.robot_file_format import MOST_SKILLS

SKILL = """
  s{number}:
    description: Do it.
    call: {{name: honk, type: std_srvs/srv/SetBool}}
    request: {{data: true}}
"""
HONK = "skills:\n  act:\n    description: d\n    call: {name: honk, type: std_srvs/srv/SetBool}\n"
HEAR = "skills:\n  act:\n    description: d\n    read: {name: x, type: std_msgs/msg/Float64}\n"
TELL = (
    "skills:\n  act:\n    description: d\n"
    "    publish: {{name: x, type: std_msgs/msg/{}}}\n    request: {{data: '{{x}}'}}\n"
    "    arguments: {{x: {}}}\n"
)
BOMB = "a: &a [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{this}: &{this} [{', '.join([f'*{before}'] * 10)}]\n"
    for before, this in zip("abcdefgh", "bcdefghi", strict=True)
)


def skills(count):
    return "skills:\n" + "".join(SKILL.format(number=number) for number in range(count))


def build(tmp_path, text):
    file = tmp_path / "robot.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return EXTERNAL.build(Settings(robot_file=file), None)


@pytest.mark.parametrize(
    ("text", "field", "expected"),
    [
        pytest.param(skills(10_000), "robot_file", "at most 1000000 bytes", id="too large"),
        pytest.param(
            skills(MOST_SKILLS + 1),
            "robot.yaml:1: skills",
            "at most 100 skills, not 101",
            id="many",
        ),
        pytest.param("skills: " + "[" * 100_000, "robot.yaml", "at most 200 brackets", id="deep"),
        pytest.param("skills: " + "{a: " * 5000, "robot.yaml", "at most 200 brackets", id="maps"),
        pytest.param(
            "".join(f"{' ' * depth}a:\n" for depth in range(1100)),
            "robot.yaml",
            "valid",
            id="lines",
        ),
        pytest.param(BOMB, "robot.yaml", "aliases that do not multiply", id="bomb"),
        pytest.param("skills: &s {a: *s}", "robot.yaml", "valid YAML", id="cycle"),
        pytest.param("skills: \0", "robot.yaml", "valid YAML", id="nul"),
        pytest.param(b"\xff\xfe\x00skills", "robot_file", "UTF-8", id="bytes"),
        pytest.param(
            "skills: !!python/object/apply:os.system ['true']", "robot.yaml", "tag", id="code"
        ),
        pytest.param("- a\n", "robot.yaml", "a mapping", id="list"),
        pytest.param("", "robot.yaml", "a mapping", id="empty"),
        pytest.param(
            TELL.format(
                "String", f"{{type: choice, values: [{', '.join(map('w{}'.format, range(501)))}]}}"
            ),
            "arguments.x.values",
            "at most 500 words, not 501",
            id="words",
        ),
        pytest.param(
            HONK
            + "    arguments: {"
            + ", ".join(f"a{n}: {{type: text}}" for n in range(21))
            + "}\n",
            "skills.act.arguments",
            "at most 20 arguments, not 21",
            id="arguments",
        ),
        pytest.param("limits: {max_linear: true}", "limits.max_linear", "a number", id="truth"),
        pytest.param("limits: {max_linear: .nan}", "limits.max_linear", "", id="nan"),
        pytest.param("limits: {max_linear: .inf}", "limits.max_linear", "", id="infinite"),
        pytest.param(HONK + "    timeout_s: '5'\n", "timeout_s", "a number", id="text"),
    ],
)
def test_a_file_that_cannot_be_is_refused_by_field(tmp_path, text, field, expected):
    with pytest.raises(InvalidValue) as caught:
        build(tmp_path, text)
    assert field in caught.value.field
    assert expected in caught.value.expected
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    ("text", "field", "expected"),
    [
        (HEAR + "    expect: [{field: data, equals: abc}]", "expect.0.equals", "a number (double)"),
        (
            HEAR + "    expect: [{field: data, equals: true}]",
            "expect.0.equals",
            "a number (double)",
        ),
        (
            HEAR + "    expect: [{field: data, equals: [1]}]",
            "robot.yaml:5: skills.act.expect.0.equals",
            "a number, a truth or a text",
        ),
        (
            HEAR.replace("Float64", "Float64MultiArray") + "    expect: [{field: data, above: 1}]",
            "expect.0.field",
            "a number, to be above",
        ),
        (
            HEAR.replace("Float64", "Float64MultiArray") + "    expect: [{field: data, equals: 1}]",
            "expect.0.equals",
            "nothing: only a number, a truth or a text",
        ),
        (TELL.format("Int32", "{type: integer, min: 5, max: 1}"), "x.max", "no less than min, 5"),
        (
            TELL.format("Int32", "{type: integer, min: 1, max: 5, default: 9}"),
            "x.default",
            "a whole number from 1 to 5",
        ),
        (TELL.format("Bool", "{type: boolean, default: 9}"), "x.default", "true or false"),
        (TELL.format("String", "{type: text, default: 9}"), "x.default", "a text"),
        (TELL.format("String", "{type: choice, values: [a], default: b}"), "x.default", "one of a"),
        (HONK + "    says: 'it {'", "skills.act.says", "in pairs of braces"),
        (HONK + "    done: 'it }'", "skills.act.done", "in pairs of braces"),
        (HONK + "    done: 'it {0}'", "skills.act.done", "a value that is known then"),
        (HONK + "    done: 'it {success.real}'", "skills.act.done", "a value that is known then"),
        (
            HONK + "    result: {well: success}\n    done: 'it {well:9999999999}'",
            "skills.act.done",
            "is written out as it is",
        ),
    ],
)
def test_what_could_never_come_true_or_would_break_while_it_runs_is_refused(
    tmp_path, text, field, expected
):
    with pytest.raises(InvalidValue) as caught:
        build(tmp_path, text + "\n")
    assert field in caught.value.field
    assert expected in caught.value.expected


def test_as_many_skills_as_there_may_be_are_made(tmp_path):
    assert len(build(tmp_path, skills(MOST_SKILLS)).skills) > MOST_SKILLS


def test_a_type_that_leaves_its_folder_or_is_none_of_ros_is_off_and_nothing_is_run(tmp_path):
    for name in ("../../evil/srv/X", "os/srv/System", "subprocess/Popen", "std_srvs/msg/SetBool"):
        text = HONK.replace("std_srvs/srv/SetBool", name)
        assert "act" not in {one.name for one in build(tmp_path, text).skills}
