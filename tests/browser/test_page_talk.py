"""What one types stands there at once, and tells whether it was heard, dropped or refused."""

from browser_rig import PHONE, Opens, page_words
from playwright.sync_api import Page, expect
from stand_in import LIVE, Robot
from test_page_drives import until


def type_in(page: Page, words: str) -> None:
    page.locator(".write input").fill(words)
    page.locator(".write input").press("Enter")


def heard(robot: Robot, turn: int, text: str) -> None:
    robot.tell(type="talk", kind="heard", turn=turn, text=text, confidence=None)


def test_typed_words_stand_there_until_they_are_heard_in_the_robots_order(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    type_in(page, "where  are you?")
    type_in(page, "go to the kitchen")
    mine, unheard = page.locator(".bubble.mine"), page.locator("[data-unheard=waiting]")
    expect(mine).to_have_text(["where  are you?", "go to the kitchen"])
    expect(unheard).to_have_count(2)
    expect(unheard.first).to_contain_text(page_words("said_waiting"))
    expect(page.locator(".write input")).to_have_value("")

    heard(robot, 7, "hello")
    heard(robot, 8, "where are you?")
    expect(mine).to_have_text(["hello", "where are you?", "go to the kitchen"])
    expect(unheard.locator(".mine")).to_have_text(["go to the kitchen"])
    heard(robot, 9, "go to the kitchen")
    expect(unheard).to_have_count(0)
    expect(mine).to_have_count(3)


def test_words_that_a_stop_made_void_say_so_unless_they_were_heard_before_it(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    type_in(page, "go to the kitchen")
    type_in(page, "go to the office")
    robot.tell(type="stop", engaged=True, by="Ada")
    dropped = page.locator("[data-unheard=undone]")
    expect(dropped.locator(".notes")).to_have_text([page_words("said_dropped")] * 2)
    heard(robot, 1, "go to the kitchen")  # the news of a stop overtakes it
    expect(dropped.locator(".mine")).to_have_text(["go to the office"])


def test_words_that_another_robot_answers_say_which_one(opens: Opens, robot: Robot) -> None:
    page = opens()
    heard(robot, 0, "hello")
    heard(robot, 0, "Rosie, go to the kitchen")
    robot.tell(type="event", kind="utterance_left", robot="Rosie")
    expect(page.locator(".turn .notes:visible")).to_have_count(1)
    expect(page.locator(".turn").last.locator(".notes")).to_contain_text("Rosie")


def test_a_stop_word_drops_what_waits_too(opens: Opens, robot: Robot) -> None:
    page = opens()
    type_in(page, "go to the kitchen")
    type_in(page, "stop")
    heard(robot, 0, "stop")
    robot.tell(type="event", kind="safety_preempt", word="stop", stopped=True)
    expect(page.locator("[data-unheard=undone] .mine")).to_have_text(["go to the kitchen"])
    expect(page.locator("[data-unheard]")).to_have_count(1)


def test_refused_words_say_why_and_are_there_to_be_sent_again(opens: Opens, robot: Robot) -> None:
    robot.answers["text"] = {"message": "a stop came first", "reason": "outdated"}
    page = opens()
    type_in(page, "go to the kitchen")
    refused = page.locator("[data-unheard=undone]")
    expect(refused.locator(".notes")).to_have_text(page_words("why_outdated"))
    expect(page.locator(".write input")).to_have_value("go to the kitchen")
    del robot.answers["text"]
    page.locator(".write input").press("Enter")
    heard(robot, 1, "go to the kitchen")
    expect(page.locator("[data-unheard=waiting]")).to_have_count(0)
    expect(refused).to_have_count(1)


def test_a_new_page_shows_the_last_turns_and_the_open_question(opens: Opens, robot: Robot) -> None:
    robot.hello["talk"] = [
        {"type": "talk", "kind": "heard", "turn": 1, "text": "kitchen", "confidence": None},
        {"type": "talk", "kind": "response", "turn": 1, "text": "Shall I go to the kitchen?"},
        {"type": "talk", "kind": "asked", "turn": 1, "text": "Shall I go?", "open": True},
    ]
    page = opens(command=False)
    expect(page.locator(".bubble")).to_have_text(["kitchen", "Shall I go to the kitchen?"])
    expect(page.locator(".question p")).to_have_text("Shall I go?")
    robot.drop()
    page.locator("html[data-link=gone]").wait_for()
    page.locator("html[data-link=ready]").wait_for()
    expect(page.locator(".bubble")).to_have_text(["kitchen", "Shall I go to the kitchen?"])


def test_the_end_of_the_conversation_stays_in_sight_when_it_gets_less_room(
    opens: Opens, robot: Robot
) -> None:
    page = opens(**PHONE)
    for turn in range(1, 16):
        heard(robot, turn, f"sentence {turn}")
    last, log = page.locator(".bubble.mine", has_text="sentence 15"), page.locator(".conversation")
    expect(last).to_be_in_viewport(ratio=1)
    robot.tell(type="stop", engaged=True, by="Ada")
    robot.tell(type="talk", kind="asked", turn=15, text="Shall I go?", open=True)
    expect(page.locator(".question")).to_be_visible()
    at_end = "e => e.scrollHeight - e.scrollTop - e.clientHeight < 2"
    until(page, lambda: log.evaluate(at_end))

    log.evaluate("e => (e.scrollTop = 0)")
    page.evaluate(
        "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )
    heard(robot, 16, "sentence 16")
    expect(page.locator(".bubble.mine", has_text="sentence 16")).to_be_attached()
    assert log.evaluate("e => e.scrollTop") == 0, "who reads further up is left there"


def test_what_can_be_said_stands_there_in_the_robots_language(opens: Opens, robot: Robot) -> None:
    robot.hello["controls"]["language"] = "de"
    page = opens(locale="en-GB", command=False)
    hint = page.locator(".conversation .empty")
    expect(hint).to_contain_text("The robot speaks Deutsch.")
    expect(hint.locator("[lang=de]")).to_have_text(page_words("talk_empty", "de"))
    robot.tell(type="controls", language="en")
    expect(hint).to_have_text(page_words("talk_empty"), use_inner_text=True)


def test_the_robots_state_says_that_it_moves_and_that_it_is_stopped(
    opens: Opens, robot: Robot
) -> None:
    robot.live = {**LIVE, "goal": None, "velocity": {"linear": 0.2, "angular": 0.0}}
    page = opens(command=False)
    expect(page.locator(".chip.state")).to_have_text(page_words("state_moving"))
    robot.live = {**LIVE, "velocity": {"linear": 0.0, "angular": 0.0}}
    expect(page.locator(".facts")).to_contain_text("0.00 m/s")
    expect(page.locator(".chip.state")).to_have_text(page_words("state_moving"))
    robot.live |= {"goal": None}
    expect(page.locator(".chip.state")).to_have_text(page_words("state_listening"))
    robot.live = {"moving": True, "goal": {"skill": "grasp", "progress": 0.42}, "joints": []}
    expect(page.locator(".chip.state")).to_have_text(page_words("state_moving"))
    expect(page.locator(".goal")).to_have_text("42 %")
    robot.live |= {"goal": None}
    expect(page.locator(".goal")).to_be_hidden()
    expect(page.locator(".chip.state")).to_have_text(page_words("state_moving"))
    robot.live |= {"moving": False}
    expect(page.locator(".chip.state")).to_have_text(page_words("state_listening"))
    robot.tell(type="stop", engaged=True, by="Anna", since=1.0)
    expect(page.locator(".chip.state")).to_have_text(page_words("state_stopped"))
