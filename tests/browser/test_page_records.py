"""A recording on the page: begun, ended, taken home, removed; a program stands for the recorder."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser_rig import DESK, PATIENCE_MS, PHONE, let_in, page_words, problems, take_the_turn
from console_rig import Rig, console
from playwright.sync_api import Browser, Page, expect
from recorder_program import RECORDS
from waiting import wait_until

from edgevox.apps.console import robot_recorder
from edgevox.apps.console.robot_recorder import KeptRecordings, NoRecorder, RobotRecorder
from edgevox.console.sessions import Role
from edgevox.core.settings import load_settings


@pytest.fixture
def recorder(tmp_path, monkeypatch) -> Iterator[RobotRecorder]:
    monkeypatch.setattr(robot_recorder, "PROGRAM", RECORDS)
    made = RobotRecorder(load_settings({}), tmp_path / "recordings", {})
    yield made
    made.stop()


@pytest.fixture
def rig(tmp_path: Path, recorder: RobotRecorder) -> Iterator[Rig]:
    given = {
        "recorder": recorder,
        "describe": lambda _: {"capabilities": {"record": True}},
        "status": lambda: {"recording": recorder.state()},
    }
    with console(tmp_path, **given) as rig:
        yield rig


def opened(browser: Browser, rig: Rig, role: Role) -> Page:
    context = browser.new_context(locale="en-GB", **DESK)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    let_in(page, rig.server.offer_code(role)[1])
    page.locator(".side-switch:visible .tab[data-panel=know]").click()
    return page


def test_it_is_begun_ended_taken_home_and_removed(
    browser: Browser, rig: Rig, recorder: RobotRecorder, tmp_path: Path
) -> None:
    page = opened(browser, rig, Role.OPERATOR)
    expect(page.get_by_role("button", name="Start recording")).to_be_enabled()
    take_the_turn(page)
    page.get_by_role("button", name="Start recording").click()
    page.get_by_role("button", name="Stop recording").wait_for()
    wait_until(lambda: list(recorder.kept.folder.glob("*/*.mcap.open")))
    page.get_by_role("button", name="Stop recording").click()
    with page.expect_download() as begun:
        page.get_by_role("link", name="edgevox-20261123-140000_0.mcap").click()
    begun.value.save_as(tmp_path / "home.mcap")
    assert (tmp_path / "home.mcap").read_bytes() == b"whole"
    assert problems(page) == []
    page.get_by_role("button", name="Delete edgevox-20261123-140000_0.mcap").click()
    page.get_by_role("alertdialog").get_by_role("button", name="Yes").click()
    expect(page.get_by_role("link", name="edgevox-20261123-140000_0.mcap")).to_have_count(0)
    assert recorder.files() == []
    page.context.close()


def test_no_press_beside_a_file_deletes_it_nor_does_a_key_that_is_held(
    browser: Browser, rig: Rig, recorder: RobotRecorder
) -> None:
    recorder.start()
    wait_until(lambda: list(recorder.kept.folder.glob("*/*.mcap.open")))
    recorder.stop()
    page = opened(browser, rig, Role.OPERATOR)
    take_the_turn(page)
    (name,) = (one.name for one in recorder.files())
    cross, asked = page.locator(f'[aria-label="Delete {name}"]'), page.get_by_role("alertdialog")
    no = asked.get_by_role("button", name="No")
    for then in ("Tab Tab", "Enter", "Enter Enter Enter", "Escape"):
        cross.click()
        expect(asked).to_contain_text(f"Delete {name}? This cannot be undone.")
        expect(no).to_be_focused()
        expect(cross).to_be_hidden()
        if then == "Tab Tab":  # the first
            assert problems(page) == []
        for key in then.split():
            page.keyboard.press(key)
        asked.or_(cross).first.wait_for()
        assert [one.name for one in recorder.files()] == [name], then
        if no.is_visible():
            no.click()
        expect(cross).to_be_visible()
    page.context.close()


def test_it_tells_when_it_was_begun_how_large_it_is_and_what_room_is_left(
    browser: Browser, rig: Rig, recorder: RobotRecorder
) -> None:
    page = opened(browser, rig, Role.OPERATOR)
    expect(page.get_by_text(re.compile(r"^[\d,]+ MB left\.$"))).to_be_visible()
    recorder.start()
    expect(page.get_by_text(re.compile(r"^0\.0 MB so far\. [\d,]+ MB left\.$"))).to_be_visible()
    wait_until(lambda: list(recorder.kept.folder.glob("*/*.mcap.open")))
    recorder.stop()
    expect(page.locator(".files li")).to_contain_text("Nov 23, 2026")
    expect(page.locator(".files li")).to_contain_text("0.0 MB")
    page.context.close()


def test_whatever_a_page_shows_it_says_that_what_is_said_is_kept(
    browser: Browser, rig: Rig, recorder: RobotRecorder
) -> None:
    context = browser.new_context(locale="en-GB", **PHONE)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    let_in(page, rig.server.offer_code(Role.VIEWER)[1])
    sign = page.get_by_role("img", name=page_words("records_now"))
    expect(sign).to_be_hidden()
    recorder.start()
    expect(sign).to_be_visible()
    expect(page.locator(".toasts")).to_contain_text(page_words("records_now"))
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert problems(page) == []
    wait_until(lambda: list(recorder.kept.folder.glob("*/*.mcap.open")))
    page.reload()
    expect(sign).to_be_visible()
    recorder.stop()
    expect(sign).to_be_hidden()
    expect(page.locator(".toasts")).to_contain_text(page_words("record_ended"))
    page.context.close()


@pytest.mark.parametrize(
    "missing",
    [
        NoRecorder.ROS2,
        pytest.param(NoRecorder.EXTRA, marks=pytest.mark.long),
        pytest.param(NoRecorder.ENCLAVE, marks=pytest.mark.long),
    ],
)
def test_where_nothing_is_recorded_it_says_why(
    browser: Browser, tmp_path: Path, missing: NoRecorder
) -> None:
    with console(tmp_path, describe=lambda _: {"capabilities": {"record": missing}}) as rig:
        page = opened(browser, rig, Role.VIEWER)
        expect(page.get_by_text(page_words(f"record_needs_{missing}"))).to_be_visible()
        expect(page.get_by_role("button", name="Start recording")).to_be_hidden()
        page.context.close()


def test_without_room_none_is_begun_and_it_says_what_to_do(
    browser: Browser, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(KeptRecordings, "room", lambda _: 1_000_000)
    page = opened(browser, rig, Role.OPERATOR)
    take_the_turn(page)
    expect(page.get_by_text(page_words("record_full"))).to_be_visible()
    expect(page.get_by_role("button", name="Start recording")).to_be_disabled()
    page.context.close()


def test_who_only_watches_sees_that_it_records_and_gets_no_files(
    browser: Browser, rig: Rig, recorder: RobotRecorder
) -> None:
    recorder.start()
    wait_until(lambda: list(recorder.kept.folder.glob("*/*.mcap.open")))
    page = opened(browser, rig, Role.VIEWER)
    expect(page.get_by_role("button", name="Stop recording")).to_be_disabled()
    recorder.stop()
    expect(page.get_by_role("button", name="Start recording")).to_be_disabled()
    assert page.locator(".files a").count() == 0
    page.context.close()


def test_one_that_failed_says_why(browser: Browser, tmp_path: Path) -> None:
    failed = {"running": False, "why": "output: disk full", "files": []}
    given = {
        "describe": lambda _: {"capabilities": {"record": True}},
        "status": lambda: {"recording": failed},
    }
    with console(tmp_path, **given) as rig:
        page = opened(browser, rig, Role.VIEWER)
        said = page_words("record_failed", why="output: disk full")
        expect(page.get_by_text(said)).to_be_visible()
        page.context.close()
