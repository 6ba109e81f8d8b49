"""Programs: orders that are repeated, delayed or wait, and all that ends them."""

import phrases
import pytest
from guards import HUNG_S
from support.conversation import drives
from waiting import wait_until

from edgevox.agent.programs import run
from edgevox.agent.programs.keeper import LEAD_S
from edgevox.agent.programs.store import LONGEST_RUN_S, LONGEST_WAIT_S, LOOK_EVERY_S, MAX_PROGRAMS
from edgevox.core.commands import CancelProgram, Interrupt, Reset
from edgevox.core.errors import InvalidValue
from edgevox.core.motion.interlock import Holder
from edgevox.core.reason import Reason

PATROL = "patrol between the kitchen and the office until I say stop"
LATER = "in five minutes, go to the office"
KEPT = phrases.said(
    "program_after", duration=phrases.said("minutes", count=5), order="going to the office."
)
NO_GARAGE = phrases.opening("unknown_word", argument="room", said="garage")
LOW = "if the battery is below twenty percent, go to the dock"


@pytest.fixture
def talk():
    with drives() as one:
        yield one


@pytest.fixture
def quick_rounds(monkeypatch):
    monkeypatch.setattr(run, "SHORTEST_ROUND_S", 0.0)


def test_a_patrol_visits_its_rooms_again_and_again_until_it_is_stopped(talk):
    assert talk.ask(PATROL) == (
        phrases.said("program_endless", order="going to the kitchen. Then: going to the office.")
    )
    talk.body.arrive(5)
    talk.body.starts_until(6)
    assert talk.ask("stop") == "Stopped." or "Stopped." in talk.said
    talk.ended()
    assert talk.body.visited == ["kitchen", "office", "kitchen", "office", "kitchen"]
    assert talk.programs == ["running", "running", "running", "cancelled"]
    assert [event.get("round") for event in talk.told("program")] == [1, 2, 3, 3]
    assert talk.said.count("I am in the kitchen.") == 1, "after a round, people know"


def test_a_question_does_not_end_a_patrol_and_a_new_order_does_and_says_so(talk):
    talk.ask(PATROL)
    talk.body.starts_until(1)
    assert talk.ask("where are you") == "I am at 1.2."
    assert talk.body.moving
    assert talk.ask("go to the bedroom") == "Going to the bedroom."
    talk.until_said("With that, the order before is off.")
    talk.body.arrive(1)
    talk.ended()
    assert talk.body.visited == ["bedroom"]


def test_an_order_is_done_so_many_times(talk, quick_rounds):
    assert talk.ask("go to the kitchen and back three times") == (
        "3 times: going to the kitchen. Then: going back."
    )
    talk.body.arrive(6)
    talk.until_said(phrases.said("program_done"))
    talk.ended()
    assert talk.body.visited == ["kitchen", "1, 2"] * 3
    assert talk.programs == ["running", "running", "running", "done"]


def test_the_robot_waits_between_two_drives_and_says_when_it_goes_on(talk):
    told = talk.ask("go to the kitchen, wait there for 0.1 seconds and come back")
    assert told == "Going to the kitchen. Then: waiting 1 second. Then: going back."
    talk.body.arrive(1)
    talk.until_said("Going to x 1, y 2.")
    talk.body.arrive(1)
    talk.ended()
    assert talk.body.visited == ["kitchen", "1, 2"]


def test_rounds_that_are_over_at_once_do_not_spin(talk, monkeypatch):
    monkeypatch.setattr(run, "SHORTEST_ROUND_S", 2 * HUNG_S)
    talk.body.arrive()
    talk.ask("go to the kitchen three times")
    talk.until_said("I am in the kitchen.")
    talk.ask("stop")
    talk.ended()
    assert talk.body.visited == ["kitchen"]
    assert talk.programs == ["running", "cancelled"]


def test_that_three_times_is_about_the_last_order_that_moved(talk, quick_rounds):
    assert "nothing was asked of me just now" in talk.ask("do that three times")
    talk.body.arrive(4)
    talk.ask("go to the office")
    talk.until_said("I am in the office.")
    talk.ask("where are you")
    assert talk.ask("three times") == "3 times: going to the office."
    talk.until_said("That is done.")
    assert talk.body.visited == ["office"] * 4


def test_an_order_for_later_is_announced_twice_and_done_in_its_time(talk):
    assert talk.ask(LATER) == "In 5 minutes: going to the office."
    (waiting,) = talk.told("program")
    assert (waiting["status"], waiting["due_in_s"]) == ("waiting", 300.0)
    talk.clock.advance(299)
    assert talk.conversation.programs.listed()["programs"][0]["due_in_s"] == 1.0
    assert not talk.body.sent
    talk.clock.advance(1)
    talk.until_said("As you asked: going to the office.")
    assert not talk.body.sent, "it says so before it moves"
    talk.clock.advance(LEAD_S)
    talk.body.arrive(1)
    talk.until_said("I am in the office.")
    talk.ended()
    assert talk.programs == ["waiting", "running", "done"]


def test_an_order_that_is_due_takes_the_place_of_what_moves(talk):
    talk.ask(LATER)
    talk.ask(PATROL)
    talk.body.starts_until(1)
    talk.clock.advance(300 + LEAD_S)
    talk.body.starts_until(2)
    talk.body.arrive(1)
    talk.until_said(phrases.said("program_replaced"))
    talk.ended()
    assert talk.body.visited == ["office"]


def test_words_for_later_end_nothing_that_moves(talk):
    talk.ask("in two minutes, say dinner is ready")
    talk.ask(PATROL)
    talk.body.starts_until(1)
    talk.clock.advance(120)
    talk.until_said("dinner is ready")
    assert talk.body.moving


def test_what_is_said_of_the_end_of_a_drive_waits_for_it(talk):
    talk.ask("go to the kitchen")
    talk.body.starts_until(1)
    talk.ask("when you are there, say hello")
    assert "hello" not in talk.said
    talk.body.arrive(1)
    talk.until_said("hello")
    talk.ended()
    assert talk.said[-2:] == ["I am in the kitchen.", "hello"]


def test_words_after_a_drive_are_dropped_if_it_does_not_arrive(talk):
    talk.ask("go to the kitchen")
    talk.body.starts_until(1)
    talk.ask("when you are there, say hello")
    talk.ask("go to the bedroom")
    talk.until(lambda: any("I have dropped this" in one for one in talk.said))
    talk.body.arrive(1)
    talk.until_said("I am in the bedroom.")
    assert "hello" not in talk.said
    assert not talk.conversation.programs.kept


def test_then_say_is_part_of_one_order(talk):
    talk.body.arrive(1)
    talk.ask("go to the kitchen and when you are there, say hello")
    talk.until_said("hello")
    assert talk.said[-2:] == ["I am in the kitchen.", "hello"]


def test_words_to_say_aloud_keep_what_an_order_would_lose(talk):
    talk.body.arrive(1)
    talk.ask("uh go to the kitchen and when you are there, say uh hello hello")
    talk.until_said("uh hello hello")


def test_a_low_battery_is_noticed_and_the_order_done_once(talk):
    assert talk.ask(LOW) == "As soon as my battery is below 20 percent: going to the dock."
    talk.clock.advance(60)
    assert not talk.body.sent
    talk.body.battery = 0.19
    talk.clock.advance(LOOK_EVERY_S + LEAD_S)
    talk.body.arrive(1)
    talk.until_said("I am in the dock.")
    talk.ended()
    talk.clock.advance(3600)
    assert talk.body.sent == ["dock"]


def test_a_robot_without_a_battery_refuses_to_wait_for_it():
    with drives(battery=False) as talk:
        assert talk.ask(LOW) == "I cannot do that: I have no battery that I know of."


@pytest.mark.parametrize(
    ("sentence", "reason"),
    [
        ("in 25 hours, go to the office", phrases.why("program_late", hours="24")),
        ("go to the office 101 times", phrases.why("program_times", said="101", count="100")),
        ("go to the office 0 times", phrases.why("program_times", said="0", count="100")),
        ("go to the office 2.5 times", phrases.why("program_times", said="2.5", count="100")),
        (
            "if the battery is below 100 percent, go to the dock",
            phrases.why("program_percent", said="100"),
        ),
        ("in 5 minutes, go to the garage", NO_GARAGE),
        ("patrol between the kitchen and the garage", NO_GARAGE),
        ("when you are there, say hello", phrases.why("nothing_moves")),
        ("in five minutes my wife comes home", phrases.opening("not_understood_but")),
        (
            ", then ".join(["go to the office"] * 9) + ", 2 times",
            phrases.why("program_long", count="8"),
        ),
    ],
)
def test_what_is_too_much_or_cannot_be_is_refused_with_its_reason(talk, sentence, reason):
    assert reason in talk.ask(sentence)
    assert not talk.conversation.programs.kept
    assert not talk.body.sent


def test_no_more_than_so_many_wait(talk):
    for minutes in range(MAX_PROGRAMS):
        talk.ask(f"in {minutes + 1} minutes, go to the office")
    assert talk.ask("in one hour, go to the kitchen") == phrases.refused("programs_full", count="8")
    assert len(talk.conversation.programs.kept) == MAX_PROGRAMS


def test_a_patrol_ends_by_itself_after_hours_and_says_why(talk):
    talk.ask(PATROL)
    talk.body.starts_until(1)
    talk.clock.advance(LONGEST_RUN_S)
    talk.until(lambda: any(phrases.why("program_over", hours="8") in one for one in talk.said))
    talk.ended()
    assert talk.told("program")[-1]["code"] == "program_over"
    assert not talk.body.moving


def test_a_condition_that_never_comes_true_is_given_up_and_said(talk):
    talk.ask(LOW)
    talk.clock.advance(LONGEST_WAIT_S)
    talk.until(lambda: any("did not happen within 24 hours" in one for one in talk.said))
    assert talk.told("program")[-1]["status"] == "failed"


def test_a_step_that_fails_ends_its_program_with_the_reason(talk):
    talk.body.locked = True
    talk.ask("go to the kitchen and back three times")
    talk.until_said("I could not do that: the door is locked.")
    talk.ended()
    assert talk.told("program")[-1]["status"] == "failed"


@pytest.mark.parametrize("waited_s", [0, 300])
def test_motion_that_is_forbidden_ends_what_waits_and_nothing_moves_when_it_is_allowed(
    talk, waited_s
):
    talk.ask(LATER)
    talk.clock.advance(waited_s)
    talk.interlock.engage(Holder.PRESENCE, Reason("another agent is in charge"))
    talk.until(lambda: any("I have dropped this" in one for one in talk.said))
    talk.interlock.release(Holder.PRESENCE)
    talk.clock.advance(3600)
    assert not talk.body.sent
    assert talk.programs[-1] == "cancelled"


def test_motion_that_is_forbidden_ends_a_patrol(talk):
    talk.ask(PATROL)
    talk.body.starts_until(1)
    talk.interlock.engage(Holder.PRESENCE, Reason("another agent is in charge"))
    talk.until_said(phrases.said("failed", reason="another agent is in charge"))
    talk.interlock.release(Holder.PRESENCE)
    talk.ended()
    assert talk.body.sent == ["kitchen"]
    assert phrases.said("program_replaced") not in talk.said


def test_while_motion_is_forbidden_no_order_for_later_is_kept(talk):
    talk.interlock.engage(Holder.PRESENCE, Reason("another agent is in charge"))
    assert talk.ask(LATER) == "I cannot do that: another agent is in charge."
    assert not talk.conversation.programs.kept


@pytest.mark.parametrize(
    "stop", ["stop", "Halt!", "cancel everything", Interrupt(), Reset(), "wait here", "skill"]
)
def test_whatever_stops_the_robot_ends_all_programs(talk, stop):
    talk.ask(LATER)
    talk.ask(LOW)
    talk.ask(PATROL)
    talk.body.starts_until(1)
    if stop == "skill":
        talk.conversation.start_goal("stop", {})
    elif isinstance(stop, str):
        talk.ask(stop)
    else:
        talk.conversation.submit(stop)
    talk.ended()
    talk.body.battery = 0.01
    talk.clock.advance(LONGEST_WAIT_S)
    assert talk.body.sent == ["kitchen"]
    assert talk.programs[-3:] == ["cancelled"] * 3


@pytest.mark.parametrize(
    "stop", ["stop", "skill", Interrupt(), Reset(), CancelProgram(""), Holder.PRESENCE]
)
def test_what_stops_the_robot_ends_programs_whose_place_was_forgotten_meanwhile(talk, stop):
    talk.body.learned = ("den",)
    talk.ask("in five minutes, go to the den")
    talk.ask("patrol between the kitchen and the den until I say stop")
    talk.body.starts_until(1)
    talk.body.learned = ()
    assert len(talk.conversation.programs.listed()["programs"]) == 2
    if stop == "skill":
        talk.conversation.start_goal("stop", {})
    elif isinstance(stop, Holder):
        talk.interlock.engage(stop, Reason("another agent is in charge"))
    elif isinstance(stop, str):
        assert talk.ask(stop).startswith("Stopped.")
    else:
        talk.conversation.submit(stop)
    talk.ended()
    assert not talk.conversation.programs.kept
    assert not talk.body.moving
    talk.clock.advance(LONGEST_WAIT_S)
    assert talk.body.sent == ["kitchen"]


def test_a_stop_that_ends_waiting_orders_says_so(talk):
    talk.ask(LATER)
    assert talk.ask("stop") == "Stopped. The orders that were waiting are off, too."
    assert talk.conversation.wait_idle(HUNG_S)  # saying that is over, too
    assert talk.ask("stop") == "I am standing still."


def test_who_interrupts_only_to_be_heard_ends_no_program(talk):
    talk.ask(LATER)
    talk.conversation.submit(Interrupt(motion=False))
    assert len(talk.conversation.programs.kept) == 1


def test_a_stop_between_the_announcement_and_the_start_counts(talk):
    talk.ask(LATER)
    talk.clock.advance(300)
    talk.until_said("As you asked: going to the office.")
    talk.ask("stop")
    talk.clock.advance(LEAD_S)
    assert not talk.body.sent


def test_orders_are_listed_and_forgotten_by_what_is_said_of_them(talk):
    assert talk.ask("which orders are waiting?") == "No orders are waiting."
    talk.ask(LATER)
    talk.ask(LOW)
    talk.ask(PATROL)
    talk.body.starts_until(1)
    talk.clock.advance(60)
    assert talk.ask("what are you going to do?") == (
        phrases.opening("program_listed") + "In 4 minutes: going to the office."
        " As soon as my battery is below 20 percent: going to the dock."
        " Now: until you stop me: going to the kitchen. Then: going to the office."
    )
    assert phrases.opening("program_endless") in talk.ask("forget the patrol")
    wait_until(lambda: not talk.conversation.moving, "its drive has ended")
    assert talk.ask("cancel the office in five minutes") == phrases.said(
        "program_forgotten", orders="In 4 minutes: going to the office."
    )
    assert "dock" in talk.ask("forget the order")
    talk.ended()
    assert talk.ask("which orders are waiting?") == "No orders are waiting."


def test_only_what_was_meant_is_forgotten(talk):
    talk.ask(LATER)
    talk.ask("in ten minutes, go to the kitchen")
    assert phrases.opening("program_which") in talk.ask("forget the order")
    talk.ask("cancel the kitchen")
    (left,) = talk.conversation.programs.listed()["programs"]
    assert left["text"] == "In 5 minutes: going to the office."
    talk.ask("forget all orders")
    assert not talk.conversation.programs.kept


def test_a_program_is_cancelled_by_its_id(talk):
    talk.ask(LATER)
    talk.ask(LOW)
    first, second = talk.conversation.programs.listed()["programs"]
    talk.conversation.submit(CancelProgram(first["program_id"]))
    assert talk.conversation.programs.listed()["programs"] == [second]
    with pytest.raises(InvalidValue, match="nobody"):
        talk.conversation.submit(CancelProgram("nobody"))
    talk.conversation.submit(CancelProgram())
    assert not talk.conversation.programs.kept


def test_every_step_is_seen_as_a_goal_of_a_program(talk):
    talk.body.arrive(2)
    talk.ask("go to the kitchen, then go to the office, 1 times")
    talk.until_said("That is done.")
    calls = [one["source"] for one in talk.events if one["kind"] == "tool_call"]
    assert calls == ["program", "program"]
    ends = [one["status"] for one in talk.events if one["kind"] == "skill_goal"]
    assert ends == ["accepted", "running", "succeeded"] * 2


def test_a_program_moves_nothing_after_its_conversation_was_closed(talk):
    talk.ask(LATER)
    talk.conversation.close()
    talk.clock.advance(3600)
    assert not talk.body.sent
    assert talk.programs == ["waiting", "cancelled"]
