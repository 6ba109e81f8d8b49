"""Control of the robot: the first command takes it, others ask for it, no tap gives it away."""

from browser_rig import Opens, page_words
from playwright.sync_api import Page, expect
from stand_in import HELLO, Robot
from test_page_drives import until


def held_by(robot: Robot, page: Page, name: str, *waiting: str) -> None:
    """Another operator has control; these clients wait for it."""
    asking = [{"client": one, "name": one} for one in waiting]
    robot.tell(type="lease", holder="x", name=name, mine=False, waiting=asking)
    expect(page.locator(".composer .other-holder")).to_be_visible()


def test_the_first_words_take_a_free_robot(opens: Opens, robot: Robot) -> None:
    page = opens(command=False)
    page.locator(".write input").fill("go to the kitchen")
    page.locator(".write input").press("Enter")
    expect(page.locator(".lease button.on")).to_have_text(page_words("you_command"))
    until(page, lambda: bool(robot.commands("text")))
    told = [one["type"] for one in robot.received if one["type"] in ("lease", "text")]
    assert told == ["lease", "text"]


def test_the_first_skill_takes_a_free_robot(opens: Opens, robot: Robot) -> None:
    page = opens(command=False)
    page.locator(".skill button").first.click()
    expect(page.locator(".lease button.on")).to_be_visible()
    until(page, lambda: len(robot.commands("skill")) == 1)


def test_where_another_has_control_the_composer_says_who_and_asks(
    opens: Opens, robot: Robot
) -> None:
    first, second = opens(), opens(command=False)
    composer = second.locator(".composer")
    expect(composer).to_contain_text(page_words("commands_now", name="client-1"))
    expect(composer.locator(".write")).to_be_hidden()
    composer.get_by_role("button", name=page_words("ask_turn")).click()
    asks = page_words("asks_turn", name="client-2")
    expect(first.get_by_role("button", name=asks)).to_be_visible()
    expect(composer).to_contain_text(page_words("asked_turn", name="client-1"))
    withdraw = composer.get_by_role("button", name=page_words("withdraw"))
    expect(withdraw).to_be_focused()

    withdraw.click()
    expect(first.locator(".lease button.on")).to_have_text(page_words("you_command"))
    expect(composer.get_by_role("button", name=page_words("ask_turn"))).to_be_focused()

    composer.get_by_role("button", name=page_words("ask_turn")).click()
    first.get_by_role("button", name=asks).click()
    first.get_by_role("button", name=page_words("give_turn", name="client-2")).click()
    expect(composer.locator(".write input")).to_be_focused()
    expect(first.locator(".composer")).to_contain_text("client-2")


def test_no_single_tap_gives_control_away(opens: Opens, robot: Robot) -> None:
    page = opens()
    own = page.get_by_role("button", name=page_words("you_command"))
    release = page.get_by_role("button", name=page_words("give_back"))
    own.click()
    expect(own).to_have_attribute("aria-expanded", "true")
    page.keyboard.press("Escape")
    expect(release).to_be_hidden()
    expect(own).to_be_focused()
    own.click()
    page.locator("h1").click()
    expect(release).to_be_hidden()
    assert [one["action"] for one in robot.commands("lease")] == ["take"]
    own.click()
    release.click()
    expect(page.get_by_role("button", name=page_words("take_turn"))).to_be_focused()


def test_typed_words_stay_while_another_has_control(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator(".write input").fill("go to the")
    held_by(robot, page, "Ada")
    robot.tell(type="lease", holder=None, name=None, mine=False, waiting=[])
    expect(page.locator(".write input")).to_have_value("go to the")


def test_a_viewer_is_told_that_it_only_looks(opens: Opens, robot: Robot) -> None:
    robot.hello = {**HELLO, "role": "viewer"}
    page = opens(command=False)
    expect(page.locator(".composer").get_by_text(page_words("viewer"))).to_be_visible()
    expect(page.locator(".write")).to_be_hidden()


def test_a_stop_takes_no_control(opens: Opens, robot: Robot) -> None:
    page = opens(command=False)
    page.locator("button.stop").click()
    until(page, lambda: bool(robot.commands("stop")))
    expect(page.locator(".stopped")).to_be_visible()
    assert not robot.commands("lease")
