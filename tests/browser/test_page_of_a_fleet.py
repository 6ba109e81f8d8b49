"""The page of many robots, in a real browser: who is let in, and what is shown."""

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from browser_rig import DESK, DEVICES, PHONE, problems
from playwright.sync_api import Browser, expect

from edgevox.apps.fleet.serve import PAGE, fleet_server
from edgevox.apps.fleet.watch import FleetRobot, FleetWatch, LastSeen, RobotStatus
from edgevox.console.page_server import PageServer
from edgevox.console.sessions import Role

WELL = RobotStatus("0.1.1.dev37", "edgevox-ros2:0.1.1.dev37", False, 0.82, 48_300.0, recording=True)
SEEN: Mapping[str, LastSeen] = {
    "kitchen": LastSeen("ready", told=WELL),
    "ward": LastSeen(
        "unwell",
        {"stt": "its thread has ended", "disk": "/data: 80 MiB left"},
        RobotStatus("0.1.0", "sha256:" + 64 * "a", True, 0.41, 80.0, recording=False),
    ),
    "hall": LastSeen(
        "warned",
        {"sim": "battery at 9 %"},
        RobotStatus("0.1.1.dev37", None, False, 0.09, 20_000.0, recording=False),
    ),
    "yard": LastSeen("gone", {"network": "no route to host"}),
    "attic": LastSeen("unknown"),
}


LANGUAGES = sorted(path.stem for path in (PAGE / "languages").glob("*.json"))


def words_of(language: str) -> dict[str, str]:
    return json.loads((PAGE / f"languages/{language}.json").read_text(encoding="utf-8"))


@pytest.fixture
def served(tmp_path: Path) -> Iterator[PageServer]:
    robots = {
        name: FleetRobot(health=f"http://{name}:1", console=f"https://{name}:8443") for name in SEEN
    }
    by_address = {f"http://{name}:1": seen for name, seen in SEEN.items()}
    watch = FleetWatch(robots, lambda robot: by_address[robot.health])
    watch.look()
    server = fleet_server(watch, tmp_path, "127.0.0.1", 0, hosts=frozenset({"127.0.0.1"}))
    server.start()
    yield server
    server.close()


@pytest.mark.parametrize("language", LANGUAGES)
def test_each_language_is_whole(language: str) -> None:
    english, its = (words_of(one) for one in ("en", language))
    places = re.compile(r"\{\w+\}")
    assert its.keys() == english.keys()
    for key, text in its.items():
        assert text.strip()
        assert sorted(places.findall(text)) == sorted(places.findall(english[key])), key


@pytest.mark.parametrize(
    ("wanted", "language", "direction"),
    [("de-AT", "de", "ltr"), ("ar-EG", "ar", "rtl"), ("cs-CZ", "en", "ltr")],
)
@pytest.mark.parametrize("device", [DESK, PHONE])
def test_it_speaks_the_browsers_language_and_english_where_it_has_no_words(
    browser: Browser, served: PageServer, wanted: str, language: str, direction: str, device: dict
) -> None:
    context = browser.new_context(locale=wanted, **device)
    page, words = context.new_page(), words_of(language)
    page.goto(served.offer_code(Role.VIEWER)[1])
    expect(page.locator("tbody tr")).to_have_count(len(SEEN))
    assert page.locator("html").get_attribute("lang") == language
    assert page.locator("html").get_attribute("dir") == direction
    assert page.title() == words["robots"]
    expect(page.locator("#summary")).to_contain_text(words["stopped_count"].format(count=1))
    expect(page.locator("td.state").first).to_have_text(words["state_gone"])
    expect(page.locator("tr.unwell [lang=en]").first).to_contain_text("stt: its thread has ended")
    assert problems(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    context.close()


@pytest.mark.parametrize(("device", "colours"), DEVICES)
def test_axe_finds_nothing(
    browser: Browser, served: PageServer, device: dict[str, object], colours: str, tmp_path: Path
) -> None:
    context = browser.new_context(**device, color_scheme=colours)
    page = context.new_page()
    broken: list[str] = []
    page.on("pageerror", lambda error: broken.append(str(error)))
    _, address = served.offer_code(Role.VIEWER)
    page.goto(address)
    expect(page.locator("tbody tr")).to_have_count(len(SEEN))
    expect(page.locator("#summary")).to_have_text(
        "2 of 5 robots ready · 1 with problems · 1 stopped"
    )
    assert problems(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (
        "it scrolls sideways"
    )
    assert not broken
    served.close()
    expect(page.locator("body")).to_have_class("stale")
    assert problems(page) == []
    context.close()


def test_a_browser_sees_nothing_until_it_has_the_code_and_then_the_ill_ones_first(
    browser: Browser, served: PageServer
) -> None:
    context = browser.new_context()
    page = context.new_page()
    page.goto(served.url)
    expect(page.locator("#summary")).to_have_text("This browser is not paired.")
    expect(page.locator("table")).to_be_hidden()
    assert problems(page) == []
    page.get_by_label("Pairing code").fill("AAAA-AAAA")
    page.get_by_role("button").click()
    expect(page.locator("#summary")).to_have_text("This is not the code, or it was used before.")
    code, _ = served.offer_code(Role.VIEWER)
    page.get_by_label("Pairing code").fill(code.shown)
    page.get_by_role("button").click()
    expect(page.locator("tbody th")).to_have_text(["yard", "ward", "hall", "attic", "kitchen"])
    expect(page.locator("tr.ready td")).to_have_text(
        [
            "ready",
            "",
            "allowed",
            "82 %",
            "47.2 GiB",
            "recording",
            "0.1.1.dev37",
            re.compile(r"\d+ s ago"),
        ]
    )
    expect(page.locator("tr.unwell td.stopped")).to_have_text("stopped")
    expect(page.locator("form")).to_be_hidden()
    context.close()
