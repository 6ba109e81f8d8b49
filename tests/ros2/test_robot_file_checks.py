"""What is wrong in a robot file is told at the start: file, line, field, and what there is."""

from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped

from edgevox.agent.name_rules import check_skills
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.core.yaml_file import YamlFile
from edgevox.ros2.external import EXTERNAL
from edgevox.ros2.robot_file.filling import Filling

EXAMPLE = Path(__file__).parents[2] / "examples" / "robot_file" / "cleaner.yaml"
LAMP = "publish: {{name: lamp, type: std_msgs/msg/{}}}\nrequest: {{data: '{{x}}'}}\n"
HONK = "call: {name: honk, type: std_srvs/srv/SetBool}"
POINT = "publish: {name: to, type: geometry_msgs/msg/PointStamped}\nrequest: {point: '{x}'}\n"
GO = "action: {name: dock, type: edgevox_msgs/action/ExecuteSkill}"
HEAR = "read: {name: pose, type: geometry_msgs/msg/PoseStamped}"


def build(tmp_path, skill, head=""):
    file = tmp_path / "robot.yaml"
    lines = "".join(f"    {line}\n" for line in skill.splitlines())
    file.write_text(f"{head}skills:\n  act:\n    description: Do it.\n{lines}")
    return EXTERNAL.build(Settings(robot_file=file), None)


@pytest.mark.parametrize(
    ("skill", "field", "expected"),
    [
        (
            HONK + "\nrequest: {datum: true}",
            "robot.yaml:5: skills.act.request.datum",
            "one of data",
        ),
        (HONK + "\nrequest: {data: 1}", "skills.act.request.data", "true or false"),
        (HONK + '\nrequest: {data: "{x}"}', "skills.act.request", "an argument"),
        (
            LAMP.format("UInt8") + "arguments: {x: {type: integer, min: 0, max: 256}}",
            "skills.act.request.data",
            "from 0 to 255 (uint8); so bound the argument 'x'",
        ),
        (
            LAMP.format("Int32") + "arguments: {x: {type: number, min: 0, max: 1}}",
            "skills.act.request.data",
            "a whole number",
        ),
        (HONK + "\narguments: {x: {type: text}}", "skills.act.arguments.x", "that a request takes"),
        (HONK + "\nresult: {why: reason}", "skills.act.result.why", "one of success, message"),
        (HEAR + "\nresult: {x: pose.position.w}", "skills.act.result.x", "one of x, y, z"),
        (HEAR + "\nrequest: {a: 1}", "skills.act.request", "no request"),
        (GO + "\nexpect: [{field: error, above: 1}]", "skills.act.expect.0.field", "a number"),
        (
            HONK + "\nexpect: [{field: success, equals: 1}]",
            "skills.act.expect.0.equals",
            "true or false, as success is",
        ),
        (
            HEAR + "\nexpect: [{field: pose.position, equals: 1}]",
            "skills.act.expect.0.field",
            "to be equal to something",
        ),
        (
            HONK + "\nexpect: [{field: message, equals: '{x}'}]",
            "skills.act.expect.0.equals",
            "an argument",
        ),
        (
            HONK + "\nresult: {why: {field: message, times: 2}}",
            "skills.act.result.why",
            "a number, to be multiplied",
        ),
        (
            LAMP.format("String") + "arguments: {x: {type: text, times: 2}}",
            "skills.act.arguments.x.times",
            "for numbers only",
        ),
        (
            POINT + "arguments: {x: {type: choice, values: {desk: {x: 1.0, up: 1.0}}}}",
            "skills.act.request.point.up",
            "a field that is one of x, y, z",
        ),
        (GO + "\nmoves: false", "skills.act.moves", "a stop can end"),
        (HONK + "\n" + GO, "skills.act", "exactly one of publish, call, action, read, wait"),
        ("says: Hello.", "skills.act", "exactly one of"),
        (HONK + '\nsentences: ["honk {loud}"]', "skills.act.sentences.0", "an argument"),
        (HONK + '\nsentences: ["honk (now"]', "skills.act.sentences.0", "a template"),
        (HONK + "\ndone: It is {loud}.", "skills.act.done", "a value that is known"),
        (HONK + "\nlanguages: {xx: {done: x}}", "skills.act.languages.xx", "a code of"),
        (HONK + "\nhorn: 1", "skills.act.horn", "no such key"),
        (
            "publish: {name: /cmd_vel, type: geometry_msgs/msg/Twist}",
            "skills.act.publish.type",
            "no velocity",
        ),
    ],
)
def test_what_is_wrong_is_told_by_line_and_field(tmp_path, skill, field, expected):
    with pytest.raises(InvalidValue) as caught:
        build(tmp_path, skill)
    assert field in caught.value.field
    assert expected in caught.value.expected


def test_no_word_of_a_skill_may_be_one_that_stops_the_robot(tmp_path):
    lamp = "publish: {name: lamp, type: std_msgs/msg/String}\nrequest: {data: '{x}'}\n"
    body = build(tmp_path, lamp + "arguments: {x: {type: choice, values: [halt, red]}}")
    with pytest.raises(InvalidValue, match="stops the robot"):
        check_skills(body.skills)


def test_a_message_is_filled_field_by_field():
    template = {
        "header": {"frame_id": "{frame}", "stamp": "now"},
        "pose": {"position": {"x": "{x}"}, "orientation": {"w": 1}},
    }
    stamp = PoseStamped().header.stamp
    stamp.sec = 7
    filled = Filling(lambda: stamp).fill(PoseStamped(), template, {"frame": "map", "x": 2})
    assert (filled.header.frame_id, filled.header.stamp.sec) == ("map", 7)
    assert (filled.pose.position.x, filled.pose.orientation.w) == (2.0, 1.0)


def test_the_file_says_how_the_robot_is_unless_a_setting_does(tmp_path):
    head = "namespace: /cleaner\nlimits: {max_linear: 0.2}\nlocations: places.yaml\n"
    (tmp_path / "places.yaml").write_text("dock: {x: 0.0, y: 0.0}\n")
    body = build(tmp_path, HONK, head)
    assert set(body.places) == {"dock"}
    assert {"navigate_to", "act"} <= {one.name for one in body.skills}


def test_the_example_is_whole():
    body = EXTERNAL.build(Settings(robot_file=EXAMPLE), None)
    written = YamlFile(EXAMPLE.read_text("utf-8"), EXAMPLE.name).data["skills"]
    assert written.keys() <= {one.name for one in body.skills}
