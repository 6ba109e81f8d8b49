from contextlib import closing
from typing import Annotated

import pytest
from dialogue_rig import Rig, Walker

from edgevox.agent.dialogue import MOST_EXCHANGES, REMEMBERED_S
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.skills import Call, OneOf, SkillFailed, SkillPhrases, SkillSet, skill
from edgevox.core.agent_events import GoalStatus
from edgevox.core.commands import Reset, RunSkill


@pytest.fixture
def rig():
    one = Rig()
    with closing(one.talk):
        yield one


def test_asked_what_it_does_it_says_so_and_how_far_it_is_and_drives_on(rig):
    rig.begin("go to the office")

    assert rig.ask("what are you doing?") == "Going to the office. 42 percent of that is done."
    assert rig.talk.wait_idle(0.0) is False
    rig.arrive()
    assert rig.ended("navigate_to") == [GoalStatus.SUCCEEDED]


def test_asked_what_it_does_it_says_when_that_is_nothing(rig):
    assert rig.say("what are you doing?") == "I am doing nothing right now."
    rig.say("go to the office")
    assert rig.say("Are you busy?") == "I am doing nothing right now."


class Cleaner(Walker):
    """A walker that sweeps, too, and says how that is asked for in two languages."""

    def __init__(self):
        super().__init__()
        german = SkillPhrases(templates=("[bitte] kehre [die] {room}", "kehre {room} aus"))
        spanish = SkillPhrases(can="barrer una sala", templates=("barre {room}",))

        @skill(templates=["sweep [the] {room}"], phrases={"de": german, "es": spanish})
        def sweep(goal, room: Annotated[str, OneOf(("hall", "porch"))]):
            """Sweep a room."""

        self.skills = SkillSet([*self.skills.values(), sweep])


@pytest.mark.parametrize(
    ("code", "asked", "first"),
    [
        ("en", "what can you do?", "I can: sweep a room; drive to a room; "),
        ("de", "was kannst du?", "Ich kann: „kehre die hall“; in ein Zimmer fahren; "),
        ("es", "¿qué puedes hacer?", "Puedo: barrer una sala; "),
        ("fr", "qu'est-ce que tu sais faire ?", "Je sais : sweep a room ; "),
    ],
)
def test_asked_what_it_can_do_it_says_first_what_only_this_robot_can(code, asked, first):
    rig = Rig(Cleaner(), language=code)
    with closing(rig.talk):
        answer = rig.hear(asked)

    assert answer.text.startswith(first)
    assert answer.detail.startswith(first)
    assert answer.detail.count(";") == len(rig.body.skills) - 1


def test_asked_why_it_quotes_the_words_and_says_that_they_were_plain(rig):
    rig.say("go to the kitchen")
    rig.say("where are you")

    why = rig.say("Why did you go there?")

    assert why == "Because I heard: “go to the kitchen”. That is a plain command."


def test_asked_why_it_says_that_it_took_words_for_a_command_and_how_sure_it_was(monkeypatch, rig):
    call = Call("navigate_to", {"room": "office"})

    def read(text, turn):
        return Meaning(rig.talk.interpreter.active, (call,), "reading", 0.93)

    monkeypatch.setattr(rig.talk.interpreter, "understand", read)
    rig.say("somebody should check the stove")
    monkeypatch.undo()

    assert rig.say("why did you do that?") == (
        "Because I heard: “somebody should check the stove”. "
        "I took that for a command and was 93 percent sure."
    )


def test_asked_why_it_names_a_program(rig):
    rig.say("go to the kitchen")
    rig.talk.start_goal("navigate_to", {"room": "office"}).wait(10.0)
    assert rig.say("why did you do that?") == "A program asked me to."

    rig.talk.submit(RunSkill("navigate_to", {"room": "kitchen"}))
    assert rig.talk.wait_idle(10.0)
    assert rig.say("why did you do that?") == "A program asked me to."


def test_asked_why_after_so_much_else_that_it_forgot_the_words_it_names_no_program(rig):
    rig.say("go to the kitchen")
    for _ in range(MOST_EXCHANGES + 1):
        rig.say("what did you hear?")
    assert rig.say("why did you do that?") == "I have done nothing lately."


def test_asked_why_after_nothing_it_says_so(rig):
    assert rig.say("why did you do that?") == "I have done nothing lately."
    rig.say("go to the kitchen")
    rig.clock.now_s += REMEMBERED_S + 1
    assert rig.say("why did you do that?") == "I have done nothing lately."


def test_asked_what_it_heard_it_quotes_the_last_words_and_never_the_question(rig):
    assert rig.say("what did you hear?") == "I did not hear anything."
    rig.say("Blorp fizzle, please.")
    assert rig.say("what did you hear?") == "I heard: “Blorp fizzle, please”."
    assert rig.say("what did I say?") == "I heard: “Blorp fizzle, please”."


def test_a_stop_word_is_among_what_it_heard(rig):
    rig.say("go to the kitchen")
    rig.say("Stop!")

    assert rig.say("what did you hear?") == "I heard: “Stop!”."


def test_a_long_sentence_is_quoted_in_part(rig):
    rig.say("blorp " * 100)

    assert len(rig.say("what did you hear?")) < 150


def test_after_a_reset_nothing_is_known_of_what_was_said(rig):
    rig.say("go to the kitchen")
    rig.talk.submit(Reset())

    assert rig.say("what did you hear?") == "I did not hear anything."
    assert rig.say("why did you do that?") == "I have done nothing lately."


def test_asked_what_it_can_do_it_says_one_sentence_and_writes_the_rest(rig):
    answer = rig.hear("what can you do here?")

    assert answer.text == (
        "I can: drive to a room; drive to a point of the map; walk forward; and 3 more things."
    )
    assert answer.detail == (
        "I can: drive to a room; drive to a point of the map; walk forward; pick up an object; "
        "put an object down; say where I am."
    )


def test_a_robot_with_few_skills_says_all_and_one_with_none_that_it_talks():
    body = Walker()
    body.skills = SkillSet([body.skills["navigate_to"], body.skills["get_pose"]])
    few = Rig(body)
    with closing(few.talk):
        assert few.say("what can you do?") == "I can: drive to a room; say where I am."
    body.skills = SkillSet(())
    none = Rig(body)
    with closing(none.talk):
        assert none.say("what can you do?") == "I can only talk."


def test_questions_are_answered_in_the_language_that_is_spoken():
    rig = Rig(language="de")
    with closing(rig.talk):
        rig.say("Fahr in die Küche.")

        assert rig.say("Warum bist du dahin gefahren?") == (
            "Weil ich gehört habe: „Fahr in die Küche“. Das ist ein klarer Befehl."
        )
        assert rig.say("Was machst du gerade?") == "Ich tue gerade nichts."


def test_what_is_remembered_is_bounded(rig):
    rig.say("go to the kitchen")
    for number in range(MOST_EXCHANGES):
        rig.say(f"blorp {number}")

    assert rig.say("again").startswith("I cannot do that: nothing was asked of me just now")


def test_a_question_is_a_call_that_everybody_sees_and_that_moves_nothing(rig):
    rig.say("what are you doing?")

    assert [one.skill for one in rig.calls] == ["what_are_you_doing"]
    assert rig.body.moves == []


def test_asked_why_after_a_yes_it_quotes_what_the_yes_was_said_to():
    rig = Rig(confirm="always")
    with closing(rig.talk):
        assert rig.say("go to the kitchen") == "Shall I do this? Going to the kitchen."
        rig.say("yes")

        why = rig.say("why did you do that?")

        assert why == "Because I heard: “go to the kitchen”. That is a plain command."
        assert rig.body.moves == ["kitchen"]


def test_what_begins_where_nobody_knows_is_known_by_its_goal_all_the_same():
    body = Walker()
    body.pose = lost
    one = Rig(body)
    with closing(one.talk):
        one.begin("go to the office")
        assert one.ask("what are you doing?").startswith("Going to the office. 42 percent")
        one.arrive()


def lost():
    raise SkillFailed("I do not know where I am.")
