from contextlib import closing

import pytest
from dialogue_rig import Model, Stage, Walker

from edgevox.agent.dialogue import REPEATABLE_S
from edgevox.core.agent_events import GoalStatus
from edgevox.core.commands import Interrupt, Reset, RunSkill
from edgevox.core.events import Cause

NOTHING = "I cannot do that: nothing was asked of me just now"
STOPPED = "I cannot do that: it was stopped."


@pytest.fixture
def stage():
    one = Stage()
    with closing(one.talk):
        yield one


@pytest.mark.parametrize("said", ["Again!", "once more", "do that again", "repeat that please"])
def test_again_does_what_was_asked_last(stage, said):
    stage.say("walk 2 metres")
    stage.say("what did you hear?")

    assert stage.say(said) == "Walking."
    assert stage.body.moves == [2.0, 2.0]


def test_again_repeats_all_of_a_joined_command_and_can_be_said_twice(stage):
    stage.say("go to the kitchen and go to the office")
    stage.say("again")
    stage.say("again")

    assert stage.body.moves == ["kitchen", "office"] * 3


def test_again_repeats_a_question_of_the_body_too(stage):
    stage.say("where are you")

    assert stage.say("again") == "I am here."


@pytest.mark.parametrize(
    "said", ["again", "go back", "further", "the other one", "and the kitchen too"]
)
def test_a_reference_to_nothing_is_answered_and_moves_nothing(stage, said):
    assert stage.say(said).startswith("I cannot do that: ")
    assert stage.body.moves == []
    assert stage.calls == []


@pytest.mark.parametrize("said", ["again", "further", "the other one", "and the office too"])
def test_nothing_is_repeated_that_was_stopped(stage, said):
    stage.begin("walk 2 metres" if said == "further" else "go to the kitchen")
    stage.say("stop")

    assert stage.say(said).startswith(STOPPED)
    assert len(stage.body.moves) == 1


def test_nothing_is_repeated_that_ended_before_a_stop(stage):
    stage.say("go to the kitchen")
    stage.say("stop")
    assert stage.say("again").startswith(STOPPED)

    stage.say("go to the office")
    stage.say("again")
    assert stage.body.moves == ["kitchen", "office", "office"]


@pytest.mark.parametrize("cause", [Cause.TOPIC, Cause.TERMINAL, Cause.PROGRAM])
def test_an_interrupt_is_such_a_stop(stage, cause):
    stage.say("go to the kitchen")
    stage.talk.submit(Interrupt(cause=cause))

    assert stage.say("again").startswith(STOPPED)


def test_who_only_speaks_over_the_robot_stops_nothing(stage):
    stage.say("go to the kitchen")
    stage.talk.submit(Interrupt("spoken over", motion=False, cause=Cause.BARGE_IN))

    assert stage.say("again") == "Going to the kitchen."


def test_what_a_program_put_an_end_to_is_not_repeated(stage):
    stage.begin("go to the kitchen")
    stage.body.slow = False
    stage.talk.start_goal("navigate_to", {"room": "office"}).wait(10.0)
    assert stage.talk.wait_idle(10.0)

    assert stage.say("again").startswith(STOPPED)


def test_what_was_asked_a_while_ago_is_not_repeated_for_whoever_comes_by(stage):
    stage.say("go to the kitchen")
    stage.clock.now_s += REPEATABLE_S + 1

    assert stage.say("again").startswith(NOTHING)
    assert stage.body.moves == ["kitchen"]


def test_the_while_counts_from_the_end_of_what_was_done(stage):
    stage.begin("go to the kitchen")
    stage.clock.now_s += REPEATABLE_S + 1
    stage.arrive()
    stage.clock.now_s += REPEATABLE_S - 1

    assert stage.say("again") == "Going to the kitchen."


def test_what_still_runs_is_neither_begun_again_nor_ended(stage):
    stage.begin("walk 2 metres")

    assert stage.ask("again") == "I cannot do that: I am still at it."
    assert stage.ask("further") == "I cannot do that: I am still at it."
    stage.arrive()
    assert stage.body.moves == [2.0]
    assert stage.ended("walk_forward") == [GoalStatus.SUCCEEDED]


def test_what_a_program_asked_is_not_repeated_for_a_person(stage):
    stage.talk.submit(RunSkill("navigate_to", {"room": "kitchen"}))
    assert stage.talk.wait_idle(10.0)

    assert stage.say("again").startswith(NOTHING)


def test_after_a_reset_there_is_nothing_to_refer_to(stage):
    stage.say("go to the kitchen")
    stage.talk.submit(Reset())

    assert stage.say("again").startswith(NOTHING)
    assert stage.say("go back").startswith("I cannot do that: I have not driven anywhere lately")


def test_back_is_where_the_last_motion_began(stage):
    stage.say("go to the kitchen")
    stage.say("go to the office")
    assert stage.say("go back") == "Going to x 1, y 0."
    assert stage.say("Go back to where you were!") == "Going to x 2, y 0."


def test_back_turns_a_drive_round_and_also_works_after_a_stop(stage):
    stage.say("go to the kitchen")
    stage.begin("go to the office")
    stage.say("stop")
    stage.body.slow = False

    assert stage.say("go back") == "Going to x 1, y 0."


def test_a_body_that_cannot_drive_to_a_point_says_so():
    body = Walker()
    skills = [one for name, one in body.skills.items() if name != "navigate_xy"]
    body.skills = type(body.skills)(skills)
    stage = Stage(body)
    with closing(stage.talk):
        stage.say("go to the kitchen")

        assert stage.say("go back") == (
            "I cannot do that: I cannot drive to a point by myself. Tell me how far to go."
        )


@pytest.mark.parametrize("said", ["further", "a bit more", "a little further please"])
def test_further_repeats_a_motion_by_so_much(stage, said):
    stage.say("walk 2 metres")

    assert stage.say(said) == "Walking."
    assert stage.body.moves == [2.0, 2.0]


def test_further_than_a_place_is_nowhere(stage):
    stage.say("go to the kitchen")

    assert stage.say("further") == (
        "I cannot do that: what I did last has no further. Tell me where to go."
    )
    assert stage.body.moves == ["kitchen"]


def test_of_two_the_other_one_is_plain(stage):
    stage.say("go to the kitchen")

    assert stage.say("the other one") == "Going to the office."
    assert stage.say("and now the other one").startswith("I did not understand")
    assert stage.say("the other one") == "Going to the kitchen."


def test_of_three_the_other_one_is_asked_for(stage):
    stage.say("take the red cube")

    assert stage.say("the other one") == (
        "I cannot do that: I would have to know which one: green cube and blue cube."
    )
    assert stage.body.moves == ["red_cube"]


@pytest.mark.parametrize(
    "said", ["and the green cube too", "also the green cube", "the same with the green cube"]
)
def test_this_one_too_puts_a_word_in_the_place_of_its_like(stage, said):
    stage.say("take the red cube and put the red cube into the left bin")
    stage.body.moves.clear()

    stage.say(said)

    assert stage.body.moves == ["green_cube", ("green_cube", "left_bin")]


def test_this_one_too_can_be_a_place_that_was_remembered_since_the_start():
    known = []
    one = Stage(Walker(learned=lambda: tuple(known)))
    with closing(one.talk):
        one.say("go to the kitchen")
        known.append("charger")
        one.say("and the charger too")

        assert one.body.moves == ["kitchen", "charger"]


def test_this_one_too_can_be_a_place_as_well(stage):
    stage.say("put the red cube into the left bin")
    stage.say("the right bin too")

    assert stage.body.moves[-1] == ("red_cube", "right_bin")


def test_after_two_of_a_kind_this_one_too_is_like_the_last(stage):
    stage.say("go to the kitchen and go to the office")
    stage.body.moves.clear()
    stage.say("the kitchen too")

    assert stage.body.moves == ["kitchen"]


def test_a_word_that_does_not_go_with_what_was_done_is_refused(stage):
    stage.say("go to the kitchen")

    assert stage.say("and the red cube too") == (
        "I cannot do that: what I did last does not go with red cube. Say all of it, please."
    )
    assert stage.body.moves == ["kitchen"]


def test_what_is_no_reference_is_left_to_whoever_understands_it(stage):
    stage.say("go to the kitchen")

    assert stage.say("and you too").startswith("I did not understand that")
    assert stage.body.moves == ["kitchen"]


def test_a_model_reads_the_calls_that_a_reference_stood_for_and_an_answer_as_words():
    stage = Stage(model=Model("get_pose()"))
    with closing(stage.talk):
        stage.say("go to the kitchen")
        stage.say("again")
        stage.say("what did you hear?")

        told = [message.content for message in stage.talk.mind.chat()][-6:]

    assert told[1] == told[3]
    assert 'navigate_to(room="kitchen")' in told[3]
    assert "I heard" in told[5]
    assert "what_did_you_hear" not in told[5]
