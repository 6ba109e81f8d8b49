"""What is wrong in a robot file is told at the start: file, line, field, and what there is."""

from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped

from edgevox.agent.name_rules import check_skills
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.own_names import phrasebook_of
from edgevox.agent.policy import Rule
from edgevox.agent.skills import Call, OwnName, SkillSet
from edgevox.apps.policy_setup import build_guard
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.core.ways import Way
from edgevox.core.yaml_file import YamlFile
from edgevox.robots.capabilities import (
    DrivesTo,
    HasPlaces,
    HasPose,
    RemembersPlaces,
    TakesVelocity,
)
from edgevox.ros2.external import EXTERNAL
from edgevox.ros2.external.external_settings import SteeringLimits
from edgevox.ros2.robot_file.described_skill import DescribedSkill
from edgevox.ros2.robot_file.filling import Filling
from edgevox.ros2.robot_file.load import load_robot_file
from edgevox.ros2.robot_file.robot_file_format import RobotFile
from edgevox.ros2.standard_topics import DRIVEN

EXAMPLE = Path(__file__).parents[2] / "examples" / "robot_file" / "cleaner.yaml"
LAMP = "publish: {{name: lamp, type: std_msgs/msg/{}}}\nrequest: {{data: '{{x}}'}}\n"
HONK = "call: {name: honk, type: std_srvs/srv/SetBool}"
POINT = "publish: {name: to, type: geometry_msgs/msg/PointStamped}\nrequest: {point: '{x}'}\n"
FOLD = "call: {name: fold, type: std_srvs/srv/Trigger}"
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
            "true or false (boolean)",
        ),
        (
            HEAR + "\nexpect: [{field: pose.position, equals: 1}]",
            "skills.act.expect.0.equals",
            "is compared",
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
        (
            GO.replace("}", ", progress: feedback_json}"),
            "skills.act.action.progress",
            "a number, which says how much is done",
        ),
        (
            GO.replace("}", ", progress: {field: part, times: 0.01}}"),
            "skills.act.action.progress",
            "one of feedback_json",
        ),
        (HONK + "\n" + GO, "skills.act", "exactly one of publish, call, action, read, wait"),
        ("says: Hello.", "skills.act", "exactly one of"),
        (HONK + '\nsentences: ["honk {loud}"]', "skills.act.sentences.0", "an argument"),
        (HONK + '\nsentences: ["honk (now"]', "skills.act.sentences.0", "a template"),
        (HONK + "\ndone: It is {loud}.", "skills.act.done", "a value that is known"),
        (HONK + "\nlanguages: {xx: {done: x}}", "skills.act.languages.xx", "a code of"),
        (
            HONK + f"\nstop: {{{HONK}, timeout_s: 60}}",
            "robot.yaml:5: skills.act.stop.timeout_s",
            "less than or equal to 5",
        ),
        (HONK + f"\nstop: {{{GO}}}", "skills.act.stop.action", "publish without rate_hz, or call"),
        (
            FOLD + "\nresult: {why: message}\nstop: "
            "{publish: {name: x, type: std_msgs/msg/String}, request: {data: '{why}'}}",
            "skills.act.stop.request",
            "an argument",
        ),
        (
            HONK + "\nstops_on: [{name: b, type: std_msgs/msg/Bool, until: "
            "[{field: pressed, equals: true}]}]",
            "robot.yaml:5: skills.act.stops_on.0.until.0.field",
            "one of data",
        ),
        (HONK + "\nstops_on: [{name: b, type: std_msgs/msg/Bool}]", "stops_on.0.until", "a value"),
        (HONK + "\nconfirm: always", "skills.act.confirm", "true or false"),
        (HONK + '\nasks: "do {what}"', "skills.act.asks", "a value that is known"),
        (HONK + "\nhorn: 1", "skills.act.horn", "no such key"),
        (HONK + "\nwords: {heard: {1: x}}", "skills.act.words.heard", "one of none"),
        (
            HONK + "\nresult: {ok: success}\nwords: {ok: {maybe: x}}",
            "skills.act.words.ok.maybe",
            "true or false",
        ),
        (
            HONK + "\nresult: {ok: success}\nwords: {ok: {true: x, 'true': x}}",
            "skills.act.words.ok",
            "each value once",
        ),
        (HONK + "\nresult: {ok: success}\nwords: {ok: {true: ''}}", "words.ok.true", "1 char"),
        (
            HONK + "\nresult: {ok: success}\ndone: It is {ok}.\nwords: {ok: {true: well}}",
            "skills.act.done",
            'words for it: words: {ok: {"true": ..., "false": ...}}',
        ),
        (
            HONK + "\nresult: {ok: success}\nwords: {ok: {true: a, false: b}}\n"
            "languages: {de: {done: 'Es ist {ok}.'}}",
            "skills.act.languages.de.done",
            "words for it",
        ),
        (
            LAMP.format("Bool") + "arguments: {x: {type: boolean}}\nsays: Now {x}.",
            "skills.act.says",
            "words for it",
        ),
        (
            HEAR + "\nresult: {x: pose.position.x}\nwords: {x: {'1.0': one}}",
            "skills.act.words.x.1.0",
            "1, as the number is said",
        ),
        (
            LAMP.format("String")
            + "arguments: {x: {type: choice, values: [red]}}\nwords: {x: {red: rot}}",
            "skills.act.words.x",
            "no choice",
        ),
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


def test_the_words_of_a_choice_have_names_by_language(tmp_path):
    lamp = "publish: {name: lamp, type: std_msgs/msg/String}\nrequest: {data: '{x}'}\n"
    choice = "arguments: {x: {type: choice, values: [red, blue], names: {NAMES}}}"
    body = build(tmp_path, lamp + choice.replace("NAMES", "red: {de: [rot, rötlich]}"))
    names = SkillSet(body.skills)["act"].choices["x"].names
    assert names == {"red": {"de": OwnName("rot", ("rötlich",))}}

    for given, field, expected in (
        ("green: {de: rot}", "x.names.green", "one of red, blue"),
        ("red: {xx: rot}", "x.names.red.xx", "a language"),
        ("red: {de: halt}", "x.names.red.de", "stops the robot"),
        ("red: {de: bunt}, blue: {de: Bunt}", "x.names.blue.de", "'red' does not have"),
    ):
        with pytest.raises(InvalidValue) as caught:
            build(tmp_path, lamp + choice.replace("NAMES", given))
        assert field in caught.value.field
        assert expected in caught.value.expected


def test_what_is_said_for_a_value_is_the_languages_and_the_result_keeps_the_value(tmp_path):
    body = build(
        tmp_path,
        "read: {name: battery, type: sensor_msgs/msg/BatteryState}\n"
        "result: {there: present, how: power_supply_status, cell: serial_number}\n"
        "done: It is {there}, {how}, {cell}.\n"
        "words: {there: {true: in, false: out}, how: {1: charging}, cell: {A7: the new one}}\n"
        "languages:\n"
        "  de:\n"
        "    done: Er ist {there}, {how}, {cell}.\n"
        "    words: {there: {true: drin, false: fort}, how: {1: am Laden}}",
    )
    act = SkillSet(body.skills)["act"]

    def said(code, **result):
        return phrasebook_of(code, [act]).report(act, {}, result)

    assert said("en", there=True, how=1, cell="A7") == "It is in, charging, the new one."
    assert said("en", there=False, how=3, cell="B1") == "It is out, 3, B1."
    assert said("de", there=True, how=1, cell="A7") == "Er ist drin, am Laden, A7."
    assert said("de", there=False, how=4, cell="B1") == "Er ist fort, 4, B1."


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


HEAD_FAULTS = [
    ("places: {dock: {x: 0.0, y: north}}\n", "robot.yaml:1: places.dock.y", "a number"),
    ("places: {dock: {x: 0.0}}\n", "robot.yaml:1: places.dock.y", "metres"),
    (
        "places:\n  dock: {x: 0.0, y: 0.0}\n  bay: {x: 1.0, y: 0.0, aliases: [dock]}\n",
        "robot.yaml:3: places.bay",
        "a name that",
    ),
    (
        "places: {dock: {x: 0.0, y: 0.0}}\nlocations: places.yaml\n",
        "robot.yaml:2: locations",
        "nothing: places stand in this file",
    ),
    ("policy: {rules: {voice: {act: ask}}}\n", "yaml:1: policy.rules.voice.act", "'confirm'"),
    ("policy: {limit: 1}\n", "robot.yaml:1: policy.limit", "no such key"),
    (
        "policy: {rules: {voice: deny}}\npolicy_file: p.yaml\n",
        "robot.yaml:2: policy_file",
        "nothing",
    ),
    ("footprint: {width: 0.4}\n", "robot.yaml:1: footprint.length", "a value"),
    ("footprint: {width: 0.4, length: -1}\n", "footprint.length", "greater than 0"),
    ("limits: {max_acceleration: 0}\n", "limits.max_acceleration", "greater than 0"),
    ("frames: {map: map}\n", "robot.yaml:1: frames", "no such key"),
    ("topics: {costmap: chart}\n", "robot.yaml:1: topics.costmap", "'odom'"),
    ("name: 3\n", "robot.yaml:1: name", "a text"),
    ("drives: sometimes\n", "robot.yaml:1: drives", "true or false"),
    *(
        (f"drives: false\n{line}\n", f"robot.yaml:2: {line.partition(':')[0]}", "nothing: drives")
        for line in (
            "topics: {odom: wheel/odometry}",
            "limits: {max_linear: 0.2}",
            "footprint: {width: 0.4, length: 0.4}",
            "places: {dock: {x: 0.0, y: 0.0}}",
            "locations: places.yaml",
        )
    ),
]


@pytest.mark.parametrize(("head", "field", "expected"), HEAD_FAULTS)
def test_what_is_wrong_about_the_robot_is_told_by_line_and_field(tmp_path, head, field, expected):
    with pytest.raises(InvalidValue) as caught:
        build(tmp_path, HONK, head)
    assert field in caught.value.field
    assert expected in caught.value.expected


def test_a_robot_that_does_not_drive_can_what_its_file_says_and_stop(tmp_path, caplog):
    build(tmp_path, HONK, "drives: false\n")
    settings = Settings(robot_file=tmp_path / "robot.yaml", max_linear=0.2)
    body = EXTERNAL.build(settings, None)
    assert [one.name for one in body.skills] == ["stop", "act"]
    assert not isinstance(body, HasPose | DrivesTo | HasPlaces | RemembersPlaces | TakesVelocity)
    (record,) = caplog.records
    assert "max_linear" in record.getMessage()


def test_places_in_the_file_are_known_unless_a_setting_names_others(tmp_path):
    head = "places:\n  dock: {x: 1.0, y: 2.0, yaw: 1.5, aliases: [home]}\n"
    body = build(tmp_path, HONK, head)
    assert body.places == {"dock": (1.0, 2.0)}
    (tmp_path / "others.yaml").write_text("bay: {x: 0.0, y: 0.0}\n")
    settings = Settings(robot_file=tmp_path / "robot.yaml", locations=tmp_path / "others.yaml")
    assert set(EXTERNAL.build(settings, None).places) == {"bay"}


@pytest.mark.parametrize(
    ("head", "settings", "rule"),
    [
        ("policy: {rules: {voice: {act: deny}}}\n", {}, Rule.DENY),
        ("policy_file: policy.yaml\n", {}, Rule.CONFIRM),
        ("policy: {rules: {voice: {act: deny}}}\n", {"policy": "policy.yaml"}, Rule.CONFIRM),
        ("", {}, Rule.ALLOW),
    ],
)
def test_the_policy_is_the_settings_else_the_files(tmp_path, head, settings, rule):
    (tmp_path / "policy.yaml").write_text("rules: {voice: {act: confirm}}\n")
    body = build(tmp_path, HONK, head)
    given = {name: tmp_path / path for name, path in settings.items()}
    guard = build_guard(Settings(**given), Bus(), body)
    assert guard.policy.judge(Way.VOICE, "act", {}).rule is rule
    assert guard.has_rules is (rule is not Rule.ALLOW)


def test_a_footprint_widens_the_strip_that_has_to_be_free_and_the_way_to_stop(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text(
        "limits: {max_linear: 1.0, max_acceleration: 0.5}\nfootprint: {length: 1.2, width: 0.7}\n"
    )
    steering = load_robot_file(file).steering(Settings())
    assert steering.half_width_m == pytest.approx(0.4)
    # Half of its length, 1 m to brake from its fastest, and what is left free.
    assert steering.stop_ahead_m == pytest.approx(0.6 + 1.0 + 0.1)
    slower = load_robot_file(file).steering(Settings(max_linear=0.3))
    assert slower.max_linear_m_s == 0.3
    assert slower.stop_ahead_m == pytest.approx(0.6 + 0.09 + 0.1)
    file.write_text("{}\n")
    assert load_robot_file(file).steering(Settings()) == SteeringLimits()


def test_a_setting_that_is_given_counts_though_it_is_the_default(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text("namespace: /cleaner\nlimits: {max_linear: 0.2}\n")
    described = load_robot_file(file)
    assert described.steering(Settings()).max_linear_m_s == 0.2
    assert described.steering(Settings(max_linear=0.3)).max_linear_m_s == 0.3
    assert described.namespace(Settings()) == "/cleaner"
    assert described.namespace(Settings(robot_namespace="/")) == "/"


def test_its_name_and_what_it_is_for_are_told_to_the_language_model(tmp_path):
    body = build(tmp_path, HONK, "name: Rosie\ndescription: A robot that honks.\n")
    (agent,) = build_agents(body)
    assert agent.instructions.endswith("Your name is Rosie. A robot that honks.")


def test_the_topics_that_may_be_called_otherwise_are_those_of_the_contract():
    topics = RobotFile.model_json_schema()["properties"]["topics"]["propertyNames"]["enum"]
    assert set(topics) == DRIVEN.keys()


@pytest.mark.parametrize(
    ("name", "skill", "sentence", "values", "done"),
    [
        ("cleaner", "set_suction", "sauge kräftig", {"power": "strong"}, "Ich sauge jetzt stark."),
        ("cleaner", "set_suction", "sauge quiet", {"power": "quiet"}, "Ich sauge jetzt leise."),
        ("base", "set_lights", "mach das Licht aus", {"colour": "dark"}, "Mein Licht ist dunkel."),
        (
            "quadruped",
            "set_gait",
            "lauf im Trab",
            {"gait": "trot"},
            "Meine Gangart ist jetzt Trab.",
        ),
        ("arm", "move_arm", "Arm bereit", {"pose": "ready"}, "Der Arm ist in Bereitschaft."),
    ],
)
def test_the_examples_say_and_hear_values_by_their_german_names(
    name, skill, sentence, values, done
):
    robot = load_robot_file(EXAMPLE.with_name(f"{name}.yaml")).robot
    one = DescribedSkill(skill, robot.skills[skill], [], None, []).skill()
    found = Recogniser(SkillSet([one]), "de").recognise(sentence)
    assert found == Understood((Call(skill, values),))
    assert phrasebook_of("de", [one]).report(one, values, {}) == done


def test_the_example_is_whole():
    body = EXTERNAL.build(Settings(robot_file=EXAMPLE), None)
    written = YamlFile(EXAMPLE.read_text("utf-8"), EXAMPLE.name).data["skills"]
    assert written.keys() <= {one.name for one in body.skills}
