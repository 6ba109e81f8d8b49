"""Skills that a robot file describes, run on a body against a robot of interfaces only."""

import phrases
import pytest
from external_rig import robot_process
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, Run, body, lasting

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled


@pytest.fixture(scope="module")
def skills(domain):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with body() as found:
            yield found


@pytest.fixture(scope="module")
def robot(domain):
    with lasting(domain) as asked:
        yield asked


@pytest.fixture
def asked(robot, skills):
    """What a robot is asked that is up and obeys, and whose door is known to be shut."""
    robot.anew()
    _knows_the_door(skills, open=False)
    return robot


def _knows_the_door(skills, **is_so):
    """What was said before is still on its way."""
    while Run(skills, "look_at_door").result() != is_so:
        pass


def test_a_service_is_called(skills, asked):
    assert Run(skills, "honk").result() == {}
    asked.wait("honk", True)


def test_what_a_service_answers_can_be_said(skills, asked):
    assert Run(skills, "fold").result() == {"joints": "seven"}


def test_a_choice_is_published_as_what_its_word_stands_for(skills, asked):
    Run(skills, "set_lamp", colour="crimson").result()
    asked.wait("lamp", 1)


def test_what_is_published_at_a_rate_ends_with_a_stop_and_its_last_word(skills, asked):
    run = Run(skills, "blink")
    asked.wait("lamp", 7)
    run.token.cancel("enough")
    with pytest.raises(Cancelled):
        run.result()
    asked.wait("lamp", 0)


def test_an_action_is_run_and_its_result_can_be_said(skills, asked):
    assert Run(skills, "dock", slot=5).result() == {"where": "slot 3"}
    asked.wait("dock", ["slot 5", "{}"])


def test_a_stop_cancels_an_action_and_does_what_the_file_wants_for_it(skills, asked):
    asked.do("hang")
    run = Run(skills, "dock")
    asked.wait("dock")
    asked.do("hang")
    run.token.cancel("stop")
    asked.wait("cancelled", "slot 3")
    asked.do("obey")
    with pytest.raises(Cancelled):
        run.result()
    asked.wait("honk", False)


@pytest.mark.parametrize(
    ("mode", "skill", "why"),
    [
        ("refuse", "honk", "The horn is broken."),
        pytest.param("hang", "honk", "The horn is broken.", marks=pytest.mark.long),
        ("refuse", "dock", phrases.interface("refused", "dock")),
        ("abort", "dock", phrases.interface("gave_up", "dock")),
        ("lie", "dock", phrases.interface("refused", "dock")),
        ("hang", "dock", phrases.interface("no_answer", "dock")),
    ],
)
def test_a_robot_that_refuses_hangs_aborts_or_lies_is_told_of(skills, asked, mode, skill, why):
    asked.do(mode)
    with pytest.raises(SkillFailed, match=why):
        Run(skills, skill).result()


@pytest.mark.long
@pytest.mark.usefixtures("skills")  # the same domain
def test_a_robot_that_is_not_there_or_dies_under_an_action_is_told_of(domain, peer, tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text(ROBOT_FILE.read_text("utf-8").replace(NAMESPACE, "/mortal"))
    with body(file) as mortal:
        with pytest.raises(SkillFailed, check=phrases.because("not_there", what="dock")):
            Run(mortal, "dock").result()
        with pytest.raises(SkillFailed, check=phrases.because("nobody_listens", what="lamp")):
            Run(mortal, "set_lamp", colour="red").result()
        with robot_process("interface_robot.py", domain=domain, namespace="/mortal") as process:
            asked = Asked(peer("/mortal"))
            asked.do("hang")
            run = Run(mortal, "dock")
            asked.wait("dock")
            process.kill()
            with pytest.raises(SkillFailed, check=phrases.because("no_answer", what="dock")):
                run.result()


def test_the_newest_value_answers_a_question(skills, asked):
    assert Run(skills, "temperature").result() == {"degrees": 41.26}


def _asks_again_and_again(skills, name):
    """Until it fails: what was heard last gets too old."""
    while True:
        Run(skills, name).result()


def test_a_value_that_is_old_is_no_answer(skills, asked):
    Run(skills, "temperature").result()
    asked.do("silent")
    try:
        with pytest.raises(SkillFailed, check=phrases.because("unheard", what="temperature")):
            _asks_again_and_again(skills, "temperature")
    finally:
        asked.do("heard")


def test_a_condition_is_waited_for_and_a_stop_ends_that(skills, asked):
    run = Run(skills, "wait_for_door")
    asked.do("open")
    assert run.result() == {}
    asked.do("shut")
    _knows_the_door(skills, open=False)
    run = Run(skills, "wait_for_door")
    run.token.cancel("stop")
    with pytest.raises(Cancelled):
        run.result()


def test_what_a_skill_stops_on_ends_it_as_failed_and_does_what_the_file_wants_then(skills, asked):
    run = Run(skills, "flash")
    asked.wait("lamp", 8)
    asked.do("open")
    with pytest.raises(SkillFailed, check=phrases.because("ended_by", what="door")):
        run.result()
    asked.wait("lamp", 9)


def test_a_skill_does_not_begin_while_what_it_stops_on_is_so(skills, asked):
    asked.do("open")
    _knows_the_door(skills, open=True)
    with pytest.raises(SkillFailed, check=phrases.because("ended_by", what="door")):
        Run(skills, "flash").result()
    Run(skills, "set_lamp", colour="red").result()
    asked.wait("lamp", 1)
    assert asked.times("lamp") == 1


def test_a_stop_of_the_person_is_no_failure_though_the_skill_watches_for_others(skills, asked):
    run = Run(skills, "flash")
    asked.wait("lamp", 8)
    run.token.cancel("enough")
    with pytest.raises(Cancelled):
        run.result()
    asked.wait("lamp", 9)


def test_a_stop_that_hangs_is_waited_for_no_longer_than_its_time(skills, asked):
    asked.do("hang")
    run = Run(skills, "dock")
    asked.wait("dock")
    run.token.cancel("stop")
    asked.wait("honk", False)
    asked.wait("cancelled", "slot 3")
    with pytest.raises(Cancelled):
        run.result()


def test_steps_are_done_in_order_and_use_what_came_of_others(skills, asked):
    asked.do("open")
    assert Run(skills, "leave").result() == {"joints": "seven"}
    asked.wait("dock", ["with seven", ""])


def test_a_skill_whose_types_are_not_there_is_off_and_the_others_work(skills):
    assert "vacuum" not in skills
    assert {"navigate_to", "stop", "honk", "dock"} - {"navigate_to"} <= set(skills)
