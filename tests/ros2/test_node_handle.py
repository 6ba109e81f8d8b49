"""What a skill's code does on ROS 2, by the agent's own node, against a robot of interfaces."""

import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import phrases
import pytest
from external_rig import robot_process
from geometry_msgs.msg import Twist
from guards import HUNG_S
from robot_file_rig import NAMESPACE, Asked, Run, lasting
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Int32
from std_srvs.srv import SetBool, Trigger
from waiting import wait_until

from edgevox.agent.skills import SkillFailed, SkillSet
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.robots.skill_packages import SkillContext
from edgevox.ros2.external import EXTERNAL
from edgevox_msgs.action import ExecuteSkill

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_ros_skill"


@pytest.fixture(scope="module")
def external(domain):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        one = EXTERNAL.build(Settings(robot_namespace=NAMESPACE), None)
        one.ros.listen(Temperature, "temperature")
        one.start()
        yield one
        one.close()


@pytest.fixture(scope="module")
def skills(external):
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(EXAMPLE)
        import dock_hand

        context = SkillContext("dock-hand", external, Settings(), external.ros)
        yield SkillSet(dock_hand.dock_hand_skills(context))


@pytest.fixture
def ros(external):
    return external.ros


@pytest.fixture
def token():
    return CancelToken()


@pytest.fixture(scope="module")
def robot(domain, external):
    """What the robot is asked, once the agent's node knows of it."""
    wanted = {f"{NAMESPACE}/honk", f"{NAMESPACE}/dock/_action/send_goal"}

    def known(node):
        there = {name for name, _ in node.get_service_names_and_types()}
        return wanted <= there and node.count_subscribers(f"{NAMESPACE}/lamp") == 1

    with lasting(domain) as asked:
        wait_until(lambda: external.ros.on_node(known), "the robot")
        yield asked


@pytest.fixture
def asked(robot):
    """What a robot is asked that obeys."""
    robot.anew()
    return robot


@pytest.fixture
def beside():
    with ThreadPoolExecutor(1) as pool:
        yield pool.submit


def test_a_service_is_called(skills, asked):
    assert Run(skills, "sound_horn").result() == {}
    asked.wait("honk", True)


def test_a_service_that_refuses_is_told_of_in_the_skills_own_words(skills, asked):
    asked.do("refuse")
    with pytest.raises(SkillFailed, match="My horn does not work") as failed:
        Run(skills, "sound_horn").result()
    assert failed.value.reason.sentences["de"] == "Meine Hupe geht nicht."


def test_a_service_that_hangs_is_waited_for_as_long_as_was_said(ros, asked, token):
    asked.do("hang")
    with pytest.raises(SkillFailed, check=phrases.because("no_answer", what="honk")) as failed:
        ros.call(SetBool, "honk", SetBool.Request(), token=token, timeout_s=0.5)
    assert "honk hat nicht rechtzeitig geantwortet" in failed.value.reason.sentences["de"].format(
        **failed.value.reason.values
    )


def test_who_waits_for_a_service_is_let_go_by_a_stop(ros, asked, token, beside):
    asked.do("hang")
    call = beside(ros.call, SetBool, "honk", SetBool.Request(), token=token, timeout_s=HUNG_S)
    asked.wait("honk", False)
    token.cancel("stop")
    with pytest.raises(Cancelled):
        call.result(HUNG_S)


def test_an_action_is_run_and_its_feedback_is_progress(skills, asked):
    asked.do("hang")
    run = Run(skills, "go_to_berth", berth=4)
    asked.wait("dock", ["berth 4", ""])
    wait_until(lambda: {"progress": 0.5} in run.reports, "its progress")
    asked.do("obey")
    assert run.result() == {"berth": 4}


def test_a_stop_cancels_an_action_and_waits_for_its_end(skills, asked):
    asked.do("hang")
    run = Run(skills, "go_to_berth")
    asked.wait("dock")
    run.token.cancel("stop")
    with pytest.raises(Cancelled):
        run.result()
    asked.wait("cancelled", "berth 1")


@pytest.mark.parametrize(("mode", "why"), [("refuse", "refused"), ("abort", "gave_up")])
def test_an_action_that_does_not_succeed_has_a_reason(skills, asked, mode, why):
    asked.do(mode)
    with pytest.raises(SkillFailed, check=phrases.because(why, what="dock")):
        Run(skills, "go_to_berth").result()


def _dock(ros, token, **more):
    goal = ExecuteSkill.Goal(skill_name="here")
    return ros.run(ExecuteSkill, "dock", goal, token=token, **more)


def test_an_action_that_hangs_is_cancelled_when_its_time_is_over(ros, asked, token):
    asked.do("hang")
    with pytest.raises(SkillFailed, check=phrases.because("no_answer", what="dock")):
        _dock(ros, token, timeout_s=1.0)
    asked.wait("cancelled", "here")


def test_what_a_skill_raises_over_feedback_cancels_the_action(ros, asked, token):
    asked.do("hang")
    with pytest.raises(ZeroDivisionError):
        _dock(ros, token, hear=lambda _: 1 / 0)
    asked.wait("cancelled", "here")


def test_feedback_is_heard_on_the_thread_of_the_skill(ros, asked, token):
    heard = []

    def hear(_):
        heard.append(threading.current_thread())
        token.cancel("it is heard")

    asked.do("hang")
    with pytest.raises(Cancelled):
        _dock(ros, token, hear=hear)
    assert heard == [threading.current_thread()]


def test_a_robot_that_dies_under_an_action_ends_it(domain, monkeypatch, peer, token, beside):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    one = EXTERNAL.build(Settings(robot_namespace="/mortal"), None)
    one.start()
    with robot_process("interface_robot.py", domain=domain, namespace="/mortal") as process:
        asked = Asked(peer("/mortal"))
        asked.do("hang")
        run = beside(_dock, one.ros, token, timeout_s=3.0)
        asked.wait("dock")
        process.kill()
        with pytest.raises(SkillFailed, check=phrases.because("no_answer", what="dock")):
            run.result(HUNG_S)
    one.close()


def test_what_is_not_there_is_told_of(ros, token):
    with pytest.raises(SkillFailed, check=phrases.because("not_there", what="nowhere")):
        ros.call(Trigger, "nowhere", Trigger.Request(), token=token, timeout_s=0.2)
    with pytest.raises(SkillFailed, check=phrases.because("nobody_listens", what="nowhere")):
        ros.publish(Int32, "nowhere", Int32(), token=token)


def test_a_message_is_published_to_who_listens(ros, asked, token):
    def is_heard() -> bool:
        # Who listens may know of a new publisher later than that of them: the first is lost then.
        ros.publish(Int32, "lamp", Int32(data=3), token=token)
        return asked.times("lamp") > 0

    wait_until(is_heard, "the lamp's message")
    asked.wait("lamp", 3)


def test_velocities_are_not_published_past_the_body(ros, token):
    with pytest.raises(InvalidValue, match="cmd_vel: got 'geometry_msgs/msg/Twist'"):
        ros.publish(Twist, "cmd_vel", Twist(), token=token)


def test_the_newest_message_answers_and_one_that_is_too_old_does_not(ros, asked, token):
    heard = ros.latest(Temperature, "temperature", token=token)
    assert heard.temperature == pytest.approx(41.26)
    with pytest.raises(SkillFailed, check=phrases.because("unheard", what="nothing")):
        ros.latest(Int32, "nothing", token=token, timeout_s=0.2)


def test_a_condition_is_waited_for_and_a_stop_ends_that(ros, asked, token, beside):
    asked.do("open")
    assert ros.wait_for(Bool, "door", lambda m: m.data, token=token, timeout_s=HUNG_S).data
    asked.do("shut")
    wait = beside(
        ros.wait_for, Bool, "door", lambda m: m.data, token=token, timeout_s=HUNG_S, oldest_s=0.0
    )
    asked.do("open")
    assert wait.result(HUNG_S).data
    never = beside(ros.wait_for, Int32, "nothing", lambda _: True, token=token, timeout_s=HUNG_S)
    token.cancel("stop")
    with pytest.raises(Cancelled):
        never.result(HUNG_S)


def test_work_is_done_on_the_thread_of_the_node_and_what_it_raises_comes_back(ros):
    first = ros.on_node(lambda _: threading.current_thread().name)
    assert (first, ros.on_node(lambda node: node.get_namespace())) == ("edgevox-ros2", NAMESPACE)
    with pytest.raises(ZeroDivisionError):
        ros.on_node(lambda _: 1 / 0)


def test_before_the_start_and_after_the_end_a_skill_is_told_that_there_is_no_node(token):
    one = EXTERNAL.build(Settings(), None)
    with pytest.raises(SkillFailed, check=phrases.because("switched_off")):
        one.ros.call(Trigger, "fold", Trigger.Request(), token=token)
    one.start()
    one.close()
    with pytest.raises(SkillFailed, check=phrases.because("switched_off")):
        one.ros.call(Trigger, "fold", Trigger.Request(), token=token)
