"""Stop works for anybody, from anywhere on the page, and stays until somebody resumes."""

import pytest
from browser_rig import PHONE, Opens, page_words, settled
from playwright.sync_api import Browser, Page, Route, expect
from stand_in import CODE, HELLO, Robot
from test_page_drives import quiet, until


def stopped(page: Page) -> None:
    expect(page.locator(".stopped")).to_be_visible(timeout=60_000)


def test_the_button_stops_at_the_press_and_says_who_did(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator("button.stop").dispatch_event("pointerdown", {"button": 0})
    stopped(page)
    expect(page.locator(".stopped p")).to_contain_text("client-1")
    assert len(robot.commands("stop")) == 1


def test_one_click_is_one_stop(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator("button.stop").click()
    stopped(page)
    settled(page)
    page.locator(".resume").click()
    expect(page.locator(".stopped")).to_be_hidden()
    assert len(robot.commands("stop")) == 1


def test_a_viewer_without_the_turn_stops_too_and_cannot_resume(opens: Opens, robot: Robot) -> None:
    robot.hello = {**HELLO, "role": "viewer"}
    page = opens(command=False)
    page.locator("button.stop").click()
    stopped(page)
    expect(page.locator(".resume")).to_be_disabled()


def test_everybody_sees_it(opens: Opens, robot: Robot) -> None:
    first, second = opens(), opens(command=False)
    first.locator("button.stop").click()
    stopped(second)


def test_the_space_bar_stops_wherever_the_focus_is_unless_it_would_write(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    places = ["button.stop", ".do-card .skill button", ".map", ".stick"]
    places += [".write input", "input[type=number]", ".skill select"]  # a space writes nothing
    for count, focus in enumerate(places, 1):
        page.locator(focus).first.focus()
        page.keyboard.press("Space")
        stopped(page)
        assert len(robot.commands("stop")) == count, focus
        assert not robot.commands("skill"), focus
        settled(page)
        page.locator(".resume").click()
        expect(page.locator(".stopped")).to_be_hidden()


def test_the_space_bar_is_a_space_where_somebody_types(opens: Opens, robot: Robot) -> None:
    page = opens()
    words = page.locator(".write input")
    words.focus()
    page.keyboard.type("go to")
    expect(words).to_have_value("go to")
    page.keyboard.press("Enter")
    expect(words).to_have_value("")
    until(page, lambda: [one["text"] for one in robot.commands("text")] == ["go to"])
    assert not robot.commands("stop")


def test_the_button_is_in_sight_on_every_part_of_a_phone(opens: Opens, robot: Robot) -> None:
    page = opens(**PHONE)
    for part in ("talk", "see", "do", "know", "settings"):
        page.locator(f".tabs [data-panel={part}]").click()
        expect(page.locator("button.stop")).to_be_in_viewport(ratio=1)
    height = page.locator("button.stop").evaluate("e => e.getBoundingClientRect().height")
    assert height >= 56


def test_what_was_stopped_before_a_page_came_is_told_to_it(opens: Opens, robot: Robot) -> None:
    robot.hello = {**HELLO, "stop": {"engaged": True, "by": "Ada"}}
    page = opens(command=False)
    expect(page.locator(".stopped p")).to_contain_text("Ada")


def test_a_space_bar_held_down_presses_nothing_when_it_is_let_go(
    opens: Opens, robot: Robot
) -> None:
    robot.hello = {**HELLO, "stop": {"engaged": True, "by": "Ada"}}
    page = opens()
    for count, focus in enumerate((".resume", ".do-card .skill button", ".lease button.on"), 1):
        page.locator(focus).first.focus()
        for _ in range(3):
            page.keyboard.down("Space")  # the second and third are the keyboard's own repeats
        page.keyboard.up("Space")
        sent = len(robot.commands("ping"))
        while len(robot.commands("ping")) < sent + 2:
            page.wait_for_timeout(20)
        assert len(robot.commands("stop")) == count, focus
        assert not robot.commands("resume"), focus
        assert not robot.commands("skill"), focus
        assert [one["action"] for one in robot.commands("lease")] == ["take"], focus


@pytest.mark.parametrize("locale", ["de-DE", "ar-EG"])
def test_the_button_stays_in_sight_where_there_is_little_room(
    opens: Opens, robot: Robot, locale: str
) -> None:
    robot.hello = {**HELLO, "stop": {"engaged": True, "by": "Ada's old telephone in the kitchen"}}
    page = opens(locale=locale, viewport={"width": 932, "height": 430}, has_touch=True)
    robot.silent = True
    page.locator("html[data-link=gone]").wait_for()
    button = page.locator("button.stop")
    for width, height in ((932, 430), (800, 390), (390, 420), (320, 256)):
        page.set_viewport_size({"width": width, "height": height})
        expect(button).to_be_in_viewport(ratio=1)
        assert button.evaluate(
            "e => { const r = e.getBoundingClientRect();"
            " return [.1, .5, .9].every(at => e.contains(document.elementFromPoint("
            "r.left + r.width / 2, r.top + at * r.height))); }"
        ), (width, height)


def test_a_stop_that_did_not_arrive_shouts_until_it_does(opens: Opens, robot: Robot) -> None:
    page = opens(**PHONE)
    lost = page.get_by_role("alert").filter(has_text=page_words("stop_lost"))
    robot.silent = True
    page.locator("button.stop").click()
    for part in ("see", "talk"):
        page.locator(f".tabs [data-panel={part}]").click()
        expect(lost).to_be_in_viewport(ratio=1)
    expect(page.locator("button.stop")).to_be_in_viewport(ratio=1)
    robot.silent = False
    stopped(page)
    expect(lost).to_be_hidden()
    assert len(robot.commands("stop")) >= 2


def test_a_dismissed_stop_is_not_sent_again(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.silent = True
    page.locator("html[data-link=gone]").wait_for()
    page.locator("button.stop").click()
    lost = page.locator(".stop-lost")
    lost.wait_for()
    settled(page)
    lost.get_by_role("button", name=page_words("close")).click()
    expect(lost).to_be_hidden()
    quiet(page, robot)
    sent = len(robot.commands("stop"))
    robot.silent = False
    page.locator("html[data-link=ready]").wait_for()
    quiet(page, robot)
    assert len(robot.commands("stop")) == sent


def test_a_stop_that_the_robot_could_not_do_shouts_too(opens: Opens, robot: Robot) -> None:
    robot.answers["stop"] = {"reason": "failed", "message": "it broke"}
    page = opens()
    page.locator("button.stop").click()
    expect(page.locator(".stop-lost")).to_be_visible()
    del robot.answers["stop"]
    page.locator("button.stop").click()
    expect(page.locator(".stop-lost")).to_be_hidden()
    stopped(page)


def test_the_header_of_a_robot_that_is_gone_is_grey_and_says_so(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.silent = True
    page.locator("html[data-link=gone]").wait_for()
    for part in (".top h1", ".top .battery", ".top .lease"):
        assert "grayscale" in page.locator(part).evaluate("e => getComputedStyle(e).filter")
    expect(page.locator(".chip.state")).to_have_text(page_words("state_gone"))


def test_stop_works_from_the_first_picture_on(browser: Browser, robot: Robot) -> None:
    context = browser.new_context(locale="en-GB")
    context.add_cookies([{"name": "edgevox", "value": CODE, "url": robot.url}])
    page = context.new_page()
    held: list[Route] = []
    page.route("**/main.js", lambda route: held.append(route))  # noqa: PLW0108 - no builtin there
    page.goto(robot.url, wait_until="domcontentloaded")
    painted = "performance.getEntriesByName('first-contentful-paint').length"
    until(page, lambda: page.evaluate(painted))
    page.locator("button.stop").click()
    until(page, lambda: robot.commands("stop"))
    until(page, lambda: held)
    held[0].continue_()
    stopped(page)
    robot.tell(type="stop", engaged=False)
    expect(page.locator(".stopped")).to_be_hidden()
    robot.drop()
    page.locator(".lease button.primary").click()  # there is a line again
    assert {one["client"] for one in robot.commands("stop")} == {"client-1"}
    context.close()


def test_a_browser_that_is_not_let_in_has_no_stop(browser: Browser, robot: Robot) -> None:
    page = browser.new_page()
    page.goto(robot.url)
    page.locator(".code").wait_for()
    expect(page.locator("button.stop")).to_have_count(0)
    page.close()
