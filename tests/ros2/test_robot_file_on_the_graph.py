"""The doctor looks on the live graph for what a robot file names: by skill, with near names."""

import pytest
from doctor_process import ask_doctor
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, interfaces
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Int32

ONLY = [part for name in ("ros2", "domain", "robot file") for part in ("--only", name)]
LAMP, INT = f"{NAMESPACE}/lamp", "std_msgs/msg/Int32"
NEEDS_OTHER_INTERFACES = "vacuum is off"


@pytest.fixture(scope="module")
def robot(domain):
    with interfaces(domain) as process:
        yield process


@pytest.fixture
def look(domain, tmp_path):
    """What the doctor says of the robot's file, changed so: its grade, and (found, advice)."""

    def run(*changes, **environment):
        text = ROBOT_FILE.read_text("utf-8")
        for before, after in changes:
            assert before in text
            text = text.replace(before, after)
        file = tmp_path / "robot.yaml"
        file.write_text(text)
        code, checks = ask_doctor("--robot-file", str(file), *ONLY, domain=domain, **environment)
        said = [
            (one["grade"], one["found"], one["advice"])
            for one in checks["robot file"]
            if not one["found"].startswith(NEEDS_OTHER_INTERFACES)
        ]
        assert len(said) == len(checks["robot file"]) - 1
        return code, said

    return run


def about(said, skill):
    """What was said of a skill."""
    return [one for one in said if one[1].startswith(f"{skill}:")]


@pytest.fixture
def heard(robot, peer):
    """The robot is up: it says what it is asked."""
    Asked(peer(NAMESPACE)).do("obey")


@pytest.mark.usefixtures("heard")
def test_all_that_is_there_is_told_skill_by_skill(look):
    code, said = look()
    assert (code, {grade for grade, *_ in said}) == (0, {"ok"})
    assert about(said, "dock") == [("ok", "dock: action /robot1/dock, service /robot1/honk", "")]
    assert {found.partition(":")[0] for _, found, _ in said} == {
        "honk",
        "fold",
        "set_lamp",
        "blink",
        "dock",
        "temperature",
        "look_at_door",
        "wait_for_door",
        "leave",
        "flash",
        "open_tray",
    }


@pytest.mark.usefixtures("heard")
def test_what_is_missing_or_does_not_fit_is_told_with_what_is_there_and_would_be_right(look):
    code, said = look(
        ("name: fold,", "name: folded,"),
        ("action: {name: dock, type", "action: {name: honk, type"),
        ("namespace: /robot1", "namespace: /robot1\ntopics: {odom: door}"),
        (
            "lamp, type: std_msgs/msg/Int32}\n    request",
            "lamp, type: std_msgs/msg/UInt8}\n    request",
        ),
        (
            "read: {name: door, type: std_msgs/msg/Bool}",
            "read: {name: door, type: std_msgs/msg/Bool, latched: true}",
        ),
    )
    ((grade, found, advice),) = about(said, "fold")
    assert (grade, found) == ("warning", "fold: service /robot1/folded is not there")
    assert advice.startswith("there is /robot1/fold (std_srvs/srv/Trigger)")
    ((_, found, advice),) = about(said, "dock")
    assert "action /robot1/honk is not there" in found
    assert advice == "/robot1/honk is there as service"
    ((grade, found, _),) = about(said, "topics")
    assert grade == "error"
    assert "has the type std_msgs/msg/Bool, and not nav_msgs/msg/Odometry" in found
    assert about(said, "set_lamp") == [
        (
            "error",
            f"set_lamp: subscriber {LAMP} has the type {INT}, and not std_msgs/msg/UInt8",
            f"type: {INT}",
        )
    ]
    ((grade, found, advice),) = about(said, "look_at_door")
    assert (grade, advice) == ("error", "latched: false")
    assert "does not fit in quality of service" in found
    assert {grade for grade, *_ in about(said, "wait_for_door")} == {"ok"}
    assert code == 1


@pytest.mark.usefixtures("heard")
def test_a_topic_of_the_contract_with_another_type_is_told_and_one_of_its_other_types_is_well(
    look, peer
):
    node = peer(NAMESPACE).node
    node.create_publisher(Int32, f"{NAMESPACE}/scan", 1)
    node.create_publisher(CompressedImage, f"{NAMESPACE}/camera/image_raw", 1)
    node.create_subscription(TwistStamped, f"{NAMESPACE}/wheels", print, 1)

    _, said = look(("namespace: /robot1", "namespace: /robot1\ntopics: {cmd_vel: wheels}"))

    fits = "sensor_msgs/msg/LaserScan or sensor_msgs/msg/PointCloud2"
    told = f"topics: publisher {NAMESPACE}/scan has the type {INT}, and not {fits}"
    assert about(said, "topics") == [("error", told, "its node has to change")]


def test_a_robot_without_a_file_is_looked_for_by_its_namespace(domain, peer):
    node = peer("/plain").node
    node.create_publisher(Odometry, "/plain/platform/odom", 1)
    node.create_subscription(Int32, "/plain/cmd_vel", print, 1)

    code, checks = ask_doctor("--robot-namespace", "plain", *ONLY, domain=domain)

    fits = "geometry_msgs/msg/Twist or geometry_msgs/msg/TwistStamped"
    misfit = f"topics: subscriber /plain/cmd_vel has the type {INT}, and not {fits}"
    assert code == 1
    assert [(one["found"], one["advice"]) for one in checks["robot file"]] == [
        (
            "topics: publisher /plain/odom is not there",
            "there is /plain/platform/odom (nav_msgs/msg/Odometry)",
        ),
        (misfit, "its node has to change"),
    ]


@pytest.mark.long
@pytest.mark.usefixtures("heard")
def test_a_namespace_that_is_wrong_is_told_with_the_right_one_and_a_setting_beats_the_file(look):
    code, said = look(EDGEVOX_EXTERNAL_NAMESPACE="/robot2")
    ((grade, found, advice),) = said
    assert (code, grade) == (0, "warning")
    assert "nothing of the robot is there" in found
    assert advice == "namespace: /robot1, where 15 of 15 are"
    _, said = look(
        ("namespace: /robot1", "namespace: /robot2"), EDGEVOX_EXTERNAL_NAMESPACE="/robot1"
    )
    assert {grade for grade, *_ in said} == {"ok"}


@pytest.mark.long
def test_a_file_that_cannot_be_used_is_told_by_its_line(domain, tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text(ROBOT_FILE.read_text("utf-8").replace("data: 7", "date: 7"))
    code, checks = ask_doctor("--robot-file", str(file), *ONLY, domain=domain)
    said, missing = checks["robot file"]
    assert (code, said["grade"], missing["grade"]) == (1, "error", "error")
    assert "skills.vacuum" in missing["found"]
    assert "skills.blink.request.date: got 7, expected a field that is one of data" in said["found"]


@pytest.mark.long
def test_a_robot_that_is_switched_off_is_told(domain, tmp_path):
    alone = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_STATIC_PEERS": "127.0.0.9"}
    code, checks = ask_doctor("--robot-file", str(ROBOT_FILE), *ONLY, domain=domain, **alone)
    said = checks["robot file"][-1]
    assert (code, said["grade"]) == (0, "warning")
    assert "nothing of the robot is there; other nodes" in said["found"]
    assert "switch the robot on" in said["advice"]
