"""A robot whose interfaces have other types than its file says, as after an update."""

import phrases
import pytest
from doctor_process import ask_doctor
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, Run, body, interfaces

from edgevox.agent.skills import SkillFailed

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def robot(domain):
    with interfaces(domain, "--changed") as process:
        yield process


@pytest.fixture(scope="module")
def skills(domain):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with body() as found:
            yield found


@pytest.fixture
def heard(robot, peer):
    """The robot is up: it has answered."""
    Asked(peer(NAMESPACE)).do("obey")


@pytest.mark.usefixtures("heard")
@pytest.mark.parametrize(
    ("skill", "arguments", "why"),
    [
        ("honk", {}, "The horn is broken"),
        ("set_lamp", {"colour": "red"}, phrases.interface("nobody_listens", "lamp")),
        ("temperature", {}, phrases.interface("unheard", "temperature")),
    ],
)
def test_what_has_another_type_fails_by_name_and_the_others_work(skills, skill, arguments, why):
    with pytest.raises(SkillFailed, match=why):
        Run(skills, skill, **arguments).result()
    assert Run(skills, "fold").result() == {"joints": "seven"}


@pytest.mark.usefixtures("heard")
def test_the_doctor_says_which_types_there_are(domain):
    only = [part for name in ("ros2", "domain", "robot file") for part in ("--only", name)]
    code, checks = ask_doctor("--robot-file", str(ROBOT_FILE), *only, domain=domain)
    errors = [one for one in checks["robot file"] if one["grade"] == "error"]
    assert code == 1
    assert {(one["found"].partition(":")[0], one["advice"]) for one in errors} == {
        ("honk", "type: std_srvs/srv/Trigger"),
        ("dock", "type: std_srvs/srv/Trigger"),
        ("set_lamp", "type: std_msgs/msg/String"),
        ("blink", "type: std_msgs/msg/String"),
        ("flash", "type: std_msgs/msg/String"),
        ("temperature", "type: std_msgs/msg/Bool"),
    }
