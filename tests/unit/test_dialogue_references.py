from contextlib import closing

import pytest
from dialogue_rig import Model, Rig, Walker

from edgevox.agent.dialogue import REPEATABLE_S
from edgevox.core.agent_events import GoalStatus
from edgevox.core.commands import Interrupt, Reset, RunSkill
from edgevox.core.events import Cause

NOTHING = "I cannot do that: nothing was asked of me just now"
STOPPED = "I cannot do that: it was stopped."


@pytest.fixture
def rig():
    one = Rig()
    with closing(one.talk):
        yield one


@pytest.mark.parametrize("said", ["Again!", "once more", "do that again", "repeat that please"])
def test_again_does_what_was_asked_last(rig, said):
    rig.say("walk 2 metres")
    rig.say("what did you hear?")

    assert rig.say(said) == "Walking."
    assert rig.body.moves == [2.0, 2.0]


def test_again_repeats_all_of_a_joined_command_and_can_be_said_twice(rig):
    rig.say("go to the kitchen and go to the office")
    rig.say("again")
    rig.say("again")

    assert rig.body.moves == ["kitchen", "office"] * 3


def test_again_repeats_a_question_of_the_body_too(rig):
    rig.say("where are you")

    assert rig.say("again") == "I am here."


@pytest.mark.parametrize(
    "said", ["again", "go back", "further", "the other one", "and the kitchen too"]
)
def test_a_reference_to_nothing_is_answered_and_moves_nothing(rig, said):
    assert rig.say(said).startswith("I cannot do that: ")
    assert rig.body.moves == []
    assert rig.calls == []


@pytest.mark.parametrize("said", ["again", "further", "the other one", "and the office too"])
def test_nothing_is_repeated_that_was_stopped(rig, said):
    rig.begin("walk 2 metres" if said == "further" else "go to the kitchen")
    rig.say("stop")

    assert rig.say(said).startswith(STOPPED)
    assert len(rig.body.moves) == 1


def test_nothing_is_repeated_that_ended_before_a_stop(rig):
    rig.say("go to the kitchen")
    rig.say("stop")
    assert rig.say("again").startswith(STOPPED)

    rig.say("go to the office")
    rig.say("again")
    assert rig.body.moves == ["kitchen", "office", "office"]


@pytest.mark.parametrize("cause", [Cause.TOPIC, Cause.TERMINAL, Cause.PROGRAM])
def test_an_interrupt_is_such_a_stop(rig, cause):
    rig.say("go to the kitchen")
    rig.talk.submit(Interrupt(cause=cause))

    assert rig.say("again").startswith(STOPPED)


def test_who_only_speaks_over_the_robot_stops_nothing(rig):
    rig.say("go to the kitchen")
    rig.talk.submit(Interrupt("spoken over", motion=False, cause=Cause.BARGE_IN))

    assert rig.say("again") == "Going to the kitchen."


def test_what_a_program_put_an_end_to_is_not_repeated(rig):
    rig.begin("go to the kitchen")
    rig.body.slow = False
    rig.talk.start_goal("navigate_to", {"room": "office"}).wait(10.0)
    assert rig.talk.wait_idle(10.0)

    assert rig.say("again").startswith(STOPPED)


def test_what_was_asked_a_while_ago_is_not_repeated_for_whoever_comes_by(rig):
    rig.say("go to the kitchen")
    rig.clock.now_s += REPEATABLE_S + 1

    assert rig.say("again").startswith(NOTHING)
    assert rig.body.moves == ["kitchen"]


def test_the_while_counts_from_the_end_of_what_was_done(rig):
    rig.begin("go to the kitchen")
    rig.clock.now_s += REPEATABLE_S + 1
    rig.arrive()
    rig.clock.now_s += REPEATABLE_S - 1

    assert rig.say("again") == "Going to the kitchen."


def test_what_still_runs_is_neither_begun_again_nor_ended(rig):
    rig.begin("walk 2 metres")

    assert rig.ask("again") == "I cannot do that: I am still at it."
    assert rig.ask("further") == "I cannot do that: I am still at it."
    rig.arrive()
    assert rig.body.moves == [2.0]
    assert rig.ended("walk_forward") == [GoalStatus.SUCCEEDED]


def test_what_a_program_asked_is_not_repeated_for_a_person(rig):
    rig.talk.submit(RunSkill("navigate_to", {"room": "kitchen"}))
    assert rig.talk.wait_idle(10.0)

    assert rig.say("again").startswith(NOTHING)


def test_after_a_reset_there_is_nothing_to_refer_to(rig):
    rig.say("go to the kitchen")
    rig.talk.submit(Reset())

    assert rig.say("again").startswith(NOTHING)
    assert rig.say("go back").startswith("I cannot do that: I have not driven anywhere lately")


def test_back_is_where_the_last_motion_began(rig):
    rig.say("go to the kitchen")
    rig.say("go to the office")
    assert rig.say("go back") == "Going to x 1, y 0."
    assert rig.say("Go back to where you were!") == "Going to x 2, y 0."


def test_back_is_no_drive_to_where_the_body_stands(rig):
    rig.say("go to the kitchen")
    rig.say("go to the office")
    rig.say("again")

    assert rig.say("go back") == "Going to x 1, y 0."
    rig.say("again")
    assert rig.body.moves[-1] == rig.body.moves[-2] == (1.0, 0.0)
    assert rig.say("go back") == "Going to x 2, y 0."


def test_back_turns_a_drive_round_and_also_works_after_a_stop(rig):
    rig.say("go to the kitchen")
    rig.begin("go to the office")
    rig.say("stop")
    rig.body.slow = False

    assert rig.say("go back") == "Going to x 1, y 0."


def test_a_body_that_cannot_drive_to_a_point_says_so():
    body = Walker()
    skills = [one for name, one in body.skills.items() if name != "navigate_xy"]
    body.skills = type(body.skills)(skills)
    rig = Rig(body)
    with closing(rig.talk):
        rig.say("go to the kitchen")

        assert rig.say("go back") == (
            "I cannot do that: I cannot drive to a point by myself. Tell me how far to go."
        )


@pytest.fixture
def arm():
    """It takes things and puts them down, and goes nowhere."""
    body = Walker()
    goes = {"navigate_to", "navigate_xy", "walk_forward"}
    body.skills = type(body.skills)(one for name, one in body.skills.items() if name not in goes)
    rig = Rig(body)
    with closing(rig.talk):
        rig.say("take the red cube")
        yield rig


@pytest.mark.parametrize(
    ("said", "answer"),
    [
        ("go back", "I cannot do that: I cannot drive to a point."),
        ("take the green cube and come back", "I cannot do that: I cannot drive to a point."),
        ("further", "I cannot do that: what I did last has no further. Say all of it, please."),
    ],
)
def test_a_body_that_goes_nowhere_does_not_ask_where_to_or_how_far(arm, said, answer):
    assert arm.say(said) == answer


@pytest.mark.parametrize("said", ["further", "a bit more", "a little further please"])
def test_further_repeats_a_motion_by_so_much(rig, said):
    rig.say("walk 2 metres")

    assert rig.say(said) == "Walking."
    assert rig.body.moves == [2.0, 2.0]


def test_further_than_a_place_is_nowhere(rig):
    rig.say("go to the kitchen")

    assert rig.say("further") == (
        "I cannot do that: what I did last has no further. Tell me where to go."
    )
    assert rig.body.moves == ["kitchen"]


def test_of_two_the_other_one_is_plain(rig):
    rig.say("go to the kitchen")

    assert rig.say("the other one") == "Going to the office."
    assert rig.say("and now the other one").startswith("I did not understand")
    assert rig.say("the other one") == "Going to the kitchen."


def test_of_three_the_other_one_is_asked_for(rig):
    rig.say("take the red cube")

    assert rig.say("the other one") == (
        "I cannot do that: I would have to know which one: green cube and blue cube."
    )
    assert rig.body.moves == ["red_cube"]


@pytest.mark.parametrize(
    "said", ["and the green cube too", "also the green cube", "the same with the green cube"]
)
def test_this_one_too_puts_a_word_in_the_place_of_its_like(rig, said):
    rig.say("take the red cube and put the red cube into the left bin")
    rig.body.moves.clear()

    rig.say(said)

    assert rig.body.moves == ["green_cube", ("green_cube", "left_bin")]


def test_this_one_too_can_be_a_place_that_was_remembered_since_the_start():
    known = []
    one = Rig(Walker(learned=lambda: tuple(known)))
    with closing(one.talk):
        one.say("go to the kitchen")
        known.append("charger")
        one.say("and the charger too")

        assert one.body.moves == ["kitchen", "charger"]


def test_this_one_too_can_be_a_place_as_well(rig):
    rig.say("put the red cube into the left bin")
    rig.say("the right bin too")

    assert rig.body.moves[-1] == ("red_cube", "right_bin")


def test_after_two_of_a_kind_this_one_too_is_like_the_last(rig):
    rig.say("go to the kitchen and go to the office")
    rig.body.moves.clear()
    rig.say("the kitchen too")

    assert rig.body.moves == ["kitchen"]


def test_a_word_that_does_not_go_with_what_was_done_is_refused(rig):
    rig.say("go to the kitchen")

    assert rig.say("and the red cube too") == (
        "I cannot do that: what I did last does not go with red cube. Say all of it, please."
    )
    assert rig.body.moves == ["kitchen"]


def test_what_is_no_reference_is_left_to_whoever_understands_it(rig):
    rig.say("go to the kitchen")

    assert rig.say("and you too").startswith("I did not understand that")
    assert rig.body.moves == ["kitchen"]


def test_a_model_reads_the_calls_that_a_reference_stood_for_and_an_answer_as_words():
    rig = Rig(model=Model("get_pose()"))
    with closing(rig.talk):
        rig.say("go to the kitchen")
        rig.say("again")
        rig.say("what did you hear?")

        told = [message.content for message in rig.talk.interpreter.chat()][-6:]

    assert told[1] == told[3]
    assert 'navigate_to(room="kitchen")' in told[3]
    assert "I heard" in told[5]
    assert "what_did_you_hear" not in told[5]
