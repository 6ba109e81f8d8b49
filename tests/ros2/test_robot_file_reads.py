"""A robot file is read as it was meant. Wrong ones: tests/wrong/robot."""

from pathlib import Path

import pytest
from example_rig import file_of
from geometry_msgs.msg import PoseStamped

from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.policy import Rule
from edgevox.agent.skills import Call, OwnName, SkillSet
from edgevox.apps.agent.policy import build_guard
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import (
    DrivesTo,
    HasPlaces,
    HasPose,
    RemembersPlaces,
    TakesVelocity,
)
from edgevox.ros2.external import EXTERNAL
from edgevox.ros2.external.settings import SteeringLimits
from edgevox.ros2.robot_file.format import MOST_SKILLS, RobotFile
from edgevox.ros2.robot_file.load import load_robot_file
from edgevox.ros2.robot_file.messages import Filling
from edgevox.ros2.robot_file.skills import DescribedSkill
from edgevox.ros2.standard_topics import DRIVEN

EXAMPLE = Path(__file__).parents[2] / "examples" / "robot_file" / "cleaner.yaml"
HONK = "call: {name: honk, type: std_srvs/srv/SetBool}"


def build(tmp_path, skill, head=""):
    file = tmp_path / "robot.yaml"
    lines = "".join(f"    {line}\n" for line in skill.splitlines())
    file.write_text(f"{head}skills:\n  act:\n    description: Do it.\n{lines}")
    return EXTERNAL.build(Settings(robot_file=file), None)


def test_as_many_skills_as_there_may_be_are_made(tmp_path):
    file = tmp_path / "robot.yaml"
    skill = f"{{description: Do it., {HONK}}}"
    file.write_text("skills:\n" + "".join(f"  s{n}: {skill}\n" for n in range(MOST_SKILLS)))
    assert len(EXTERNAL.build(Settings(robot_file=file), None).skills) > MOST_SKILLS


@pytest.mark.parametrize(
    "name", ["../../evil/srv/X", "os/srv/System", "subprocess/Popen", "std_srvs/msg/SetBool"]
)
def test_a_type_that_leaves_its_folder_or_is_none_of_ros_is_off_and_nothing_is_run(tmp_path, name):
    body = build(tmp_path, HONK.replace("std_srvs/srv/SetBool", name))
    assert "act" not in {one.name for one in body.skills}


def test_no_word_of_a_skill_may_be_one_that_stops_the_robot(tmp_path):
    lamp = "publish: {name: lamp, type: std_msgs/msg/String}\nrequest: {data: '{x}'}\n"
    with pytest.raises(InvalidValue, match="robot.yaml:6: .*stops the robot"):
        build(tmp_path, lamp + "arguments: {x: {type: choice, values: [halt, red]}}")


def test_the_words_of_a_choice_have_names_by_language(tmp_path):
    lamp = "publish: {name: lamp, type: std_msgs/msg/String}\nrequest: {data: '{x}'}\n"
    choice = "arguments: {x: {type: choice, values: [red, blue], names: {NAMES}}}"
    body = build(tmp_path, lamp + choice.replace("NAMES", "red: {de: [rot, rötlich]}"))
    names = SkillSet(body.skills)["act"].choices["x"].names
    assert names == {"red": {"de": OwnName("rot", ("rötlich",))}}


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


def test_a_files_own_sentence_counts_before_those_of_driving_by_an_amount(tmp_path):
    body = build(tmp_path, HONK + "\nsentences: [turn around, back up]")
    recogniser = Recogniser(SkillSet(body.skills))

    assert recogniser.recognise("turn around") == Understood((Call("act"),))
    assert recogniser.recognise("turn left") == Understood((Call("turn_left"),))


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
        (
            "turtlebot4",
            "set_lights",
            "mach das Licht aus",
            {"colour": "dark"},
            "Mein Licht ist dunkel.",
        ),
        (
            "quadruped",
            "set_gait",
            "lauf im Trab",
            {"gait": "trot"},
            "Meine Gangart ist jetzt Trab.",
        ),
        ("ur5e", "move_arm", "Arm bereit", {"pose": "ready"}, "Der Arm ist in Bereitschaft."),
    ],
)
def test_the_examples_say_and_hear_values_by_their_german_names(
    name, skill, sentence, values, done
):
    robot = load_robot_file(file_of(name)).robot
    one = DescribedSkill(skill, robot.skills[skill], [], None, []).skill()
    found = Recogniser(SkillSet([one]), "de").recognise(sentence)
    assert found == Understood((Call(skill, values),))
    assert phrasebook_of("de", [one]).report(one, values, {}) == done


def test_the_example_is_whole():
    body = EXTERNAL.build(Settings(robot_file=EXAMPLE), None)
    written = YamlFile(EXAMPLE.read_text("utf-8"), EXAMPLE.name).data["skills"]
    assert written.keys() <= {one.name for one in body.skills}
