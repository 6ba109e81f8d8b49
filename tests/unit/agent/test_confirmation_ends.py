"""A question that is not answered ends: it expires, is replaced, or is cancelled by a stop."""

import threading

import pytest
from guards import HUNG_S
from support.clock import HeldClock
from support.conversation import Talk

from edgevox.agent.dialogue.question import EXPIRES_S, OpenQuestion, Question
from edgevox.agent.nlu.meaning import Meaning
from edgevox.core.agent_events import (
    Confirmation,
    ConfirmationStatus,
    GoalChanged,
    GoalStatus,
    ToolCalled,
)
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, Interrupt, Reset, SpokenOver, TextInput
from edgevox.core.events import TurnEnded
from edgevox.core.speech import Spoken


def test_a_yes_in_time_counts_and_one_too_late_never_moves_the_robot():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        talk.clock.now_s += EXPIRES_S - 0.1
        talk.say("yes")
        assert talk.body.sent == ["kitchen"]
        talk.say("go to the office")
        talk.clock.now_s += EXPIRES_S
        talk.say("yes", "yes")
        assert talk.body.sent == ["kitchen"]
        assert talk.statuses[2:] == ["asked", "expired"]
        assert talk.said[-1] == "Yes. What can I do for you?"


def test_a_question_expires_by_itself_though_nobody_says_anything():
    with Talk(confirm="always") as talk:

        def let_time_pass(event):  # the question's turn is over; its thread has not waited yet
            talk.clock.now_s += EXPIRES_S

        talk.bus.subscribe(TurnEnded, let_time_pass)
        talk.conversation.submit(TextInput("go to the kitchen"))
        talk.until(lambda: len(talk.statuses) > 1)
        assert talk.statuses == ["asked", "expired"]


def test_words_that_would_be_a_command_are_none_after_a_question_that_expired():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        talk.clock.now_s += EXPIRES_S
        talk.say("go ahead")
        assert talk.body.sent == []
        talk.conversation.set_confirm("unsure")
        talk.say("where are you", "go ahead")
        assert talk.body.sent == [1.0]


@pytest.mark.parametrize("said", ["sing a song", "yes, but not now"])
def test_what_is_no_question_and_no_answer_replaces_it_and_is_handled_as_usual(said):
    with Talk(confirm="always") as talk:
        talk.say(said)
        usual = talk.said[-1]
        talk.say("go to the kitchen", said)
        assert talk.said[-1] == usual
        assert talk.statuses == ["asked", "replaced"]
        talk.say("yes")
        assert talk.body.sent == []


def test_a_question_to_the_robot_is_answered_and_the_open_one_is_asked_again():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen", "where are you")
        assert talk.said[-1] == "I am at 1.2. Shall I go to the kitchen?"
        assert talk.statuses == ["asked", "replaced", "asked"]
        talk.say("yes")
        assert talk.body.sent == ["kitchen"]


def test_a_new_question_replaces_the_old_one_and_a_yes_is_for_the_new_one():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen", "go to the office", "yes")
        assert talk.statuses == ["asked", "replaced", "asked", "confirmed"]
        assert talk.body.sent == ["office"]


@pytest.mark.parametrize(
    "command", [TextInput("stop"), Heard("halt", 1000.0), Interrupt(), Reset()], ids=str
)
def test_a_stop_of_any_kind_cancels_it_before_anything_else_is_heard(command):
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        talk.conversation.submit(command)
        assert talk.statuses == ["asked", "cancelled"]
        talk.say("yes", "yes")
        assert talk.body.sent == []


def test_who_only_speaks_over_it_may_still_answer_it():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        talk.conversation.submit(Interrupt(motion=False))
        talk.say("yes")
        assert talk.body.sent == ["kitchen"]


def test_a_yes_that_is_sent_while_a_stop_is_told_does_not_move_the_robot():
    with Talk(confirm="always") as talk:
        told = []

        def answer(event):
            if event.status is ConfirmationStatus.CANCELLED:
                talk.conversation.submit(TextInput("yes"))
                told.append(event)

        talk.bus.subscribe(Confirmation, answer)
        talk.say("go to the kitchen", "stop")
        assert len(told) == 1
        assert talk.body.sent == []


def test_a_yes_that_comes_while_the_body_is_halted_does_not_move_the_robot():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        talk.body.on_halt = lambda: talk.conversation.submit(TextInput("yes"))
        talk.conversation.submit(TextInput("stop"))
        talk.settle()
        assert talk.body.sent == []
        assert talk.statuses == ["asked", "cancelled"]


REAL_LOCK = threading.Lock


class ToldLock:
    """A lock that tells when this thread has to wait for it."""

    def __init__(self, thread, on_wait):
        self._lock, self._thread, self._on_wait = REAL_LOCK(), thread, on_wait

    def acquire(self, blocking=True, timeout=-1):
        if self._lock.acquire(blocking=False):
            return True
        if blocking and threading.get_ident() == self._thread.ident:
            self._on_wait()
        return self._lock.acquire(blocking, timeout)

    def release(self):
        self._lock.release()

    def __enter__(self):
        self.acquire()

    def __exit__(self, *_):
        self.release()


def test_a_stop_while_a_yes_begins_to_move_the_robot_leaves_it_standing(monkeypatch):
    """The stop comes when the yes has passed all checks, and goes as far as it is let."""
    stopped_or_waits = threading.Event()

    def stop():
        talk.conversation.submit(TextInput("stop"))
        stopped_or_waits.set()

    stopping = threading.Thread(target=stop)
    with monkeypatch.context() as patched:
        patched.setattr(threading, "Lock", lambda: ToldLock(stopping, stopped_or_waits.set))
        talk = Talk(confirm="always")

    def about_to_move(event):
        if event.status is GoalStatus.ACCEPTED:
            stopping.start()
            assert stopped_or_waits.wait(HUNG_S)

    talk.bus.subscribe(GoalChanged, about_to_move)
    with talk:
        talk.body.drive_on()  # what would begin to drive would never end by itself
        talk.say("go to the kitchen")
        talk.conversation.submit(TextInput("yes"))
        talk.settle(), "it drives after a stop"
        stopping.join(HUNG_S)
        assert not talk.body.moving


def test_a_stop_between_a_yes_and_its_motion_keeps_the_robot_from_moving():
    with Talk(confirm="always") as talk:
        talk.bus.subscribe(ToolCalled, lambda _: talk.conversation.submit(TextInput("stop")))
        talk.say("go to the kitchen", "yes")
        assert talk.statuses == ["asked", "confirmed"]
        assert talk.body.sent == []


def question(turn):
    return Question(Meaning(None, (), "template"), f"Shall I? {turn}", turn)


def test_a_turn_that_was_stopped_while_it_thought_asks_nothing_any_more():
    bus, told = Bus(), []
    bus.subscribe(Confirmation, told.append)
    asked = OpenQuestion(bus, HeldClock())
    asked.cancel(turn=3)
    assert not asked.ask(question(3))
    assert asked.ask(question(4))
    assert [one.turn for one in told] == [4]


class Saying:
    """Plays as much of a question as the test wants before it is spoken over."""

    def __init__(self, token, on_audible, speech_output):
        self._token, self._on_audible, self._speech_output = token, on_audible, speech_output

    def say(self, sentence):
        self._speech_output.began.set()
        if self._speech_output.audible:
            self._on_audible()

    def finish(self):
        assert self._token.wait(60)
        first_s = self._speech_output.clock.now() if self._speech_output.audible else None
        return Spoken("", cut=True, first_audible_s=first_s)


class PacedSpeech:
    def __init__(self, *, audible):
        self.audible, self.began, self.clock = audible, threading.Event(), None

    def begin(self, token, on_audible):
        return Saying(token, on_audible, self)

    def hold(self):
        """It plays no further anyway."""

    def release(self):
        """It plays no further, not even then."""


@pytest.mark.parametrize(("audible", "status"), [(True, "confirmed"), (False, "cancelled")])
def test_a_question_that_is_spoken_over_stands_if_any_of_it_was_heard(audible, status):
    speech_output = PacedSpeech(audible=audible)
    with Talk(confirm="always", speech_output=speech_output) as talk:
        speech_output.clock = talk.clock
        talk.conversation.submit(TextInput("go to the kitchen"))
        assert speech_output.began.wait(60)
        talk.conversation.submit(Interrupt(motion=False))
        talk.settle()
        talk.conversation.submit(TextInput("yes"))
        talk.until(lambda: len(talk.statuses) > 1)
        assert talk.statuses == ["asked", status]


def test_a_yes_over_its_question_is_an_answer_and_no_sign_of_listening():
    speech_output = PacedSpeech(audible=True)
    with Talk(confirm="always", speech_output=speech_output) as talk:
        speech_output.clock = talk.clock
        talk.conversation.submit(TextInput("go to the kitchen"))
        assert speech_output.began.wait(60)
        talk.conversation.submit(SpokenOver())
        talk.conversation.submit(Heard("yes", ended_s=talk.clock.now() + 1.0, over=True))
        talk.until(lambda: len(talk.statuses) > 1)
        assert talk.statuses == ["asked", "confirmed"]


def test_a_yes_that_was_spoken_before_the_question_and_understood_after_it_is_no_answer():
    with Talk(confirm="always") as talk:
        talk.say("go to the kitchen")
        talk.hear("yes", ended_s=talk.clock.now() - 1.0)
        assert talk.body.sent == []
        talk.hear("yes", ended_s=talk.clock.now() + 1.0)
        assert talk.body.sent == ["kitchen"]
