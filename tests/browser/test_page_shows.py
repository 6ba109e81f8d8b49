"""The conversation, the map, the forms, the settings, and all of it for keyboard and reader."""

import gzip
import io
import json
import re

import pytest
from browser_rig import DEVICES, PHONE, Opens, page_words, problems, settled
from PIL import Image
from playwright.sync_api import Browser, expect
from stand_in import HELLO, Robot
from test_page_drives import until

from edgevox.console.page_files import PAGE
from edgevox.core.events import Outcome, State
from edgevox.core.status import ComponentName

LANGUAGES = sorted(path.stem for path in (PAGE / "languages").glob("*.json"))


def test_an_answer_streams_and_ends_as_it_was_meant(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.tell(type="talk", kind="heard", turn=1, text="Where are you?")
    for piece in ("I am", " in the", " kit"):
        robot.tell(type="talk", kind="token", turn=1, text=piece)
    expect(page.locator(".bubble.robots")).to_have_text("I am in the kit")
    robot.tell(type="talk", kind="response", turn=1, text="I am in the kitchen.")
    expect(page.locator(".bubble.robots")).to_have_text("I am in the kitchen.")
    expect(page.locator(".bubble.mine")).to_have_text("Where are you?")


def test_what_was_decided_is_told_by_stage_and_sureness(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.tell(type="talk", kind="heard", turn=1, text="Kitchen!", confidence=0.83)
    goes = {"skill": "navigate_to", "arguments": {"room": "kitchen"}}
    robot.tell(type="talk", kind="decided", turn=1, calls=[goes], stage="reading", confidence=0.97)
    robot.tell(type="event", kind="tool_call", **goes, source="reading", turn=1)
    robot.tell(type="talk", kind="turn_ended", turn=1, outcome="asked", stage=None)
    robot.tell(type="talk", kind="heard", turn=2, text="Yes", confidence=None)
    robot.tell(type="event", kind="tool_call", **goes, source="reading", turn=2)
    done, how = "go to a room: kitchen", "navigate_to(kitchen) · by reading the sentence"
    expect(page.locator(".notes")).to_have_text([f"{done} · {page_words('outcome_asked')}", done])
    why = page.locator(".why")
    expect(why.locator("p")).to_have_text([f"heard with 83 % certainty · {how} · 97 % sure", how])
    expect(why.locator("p").first).to_be_hidden()
    why.locator("summary").first.click()
    expect(why.locator("p").first).to_be_visible()


def test_numbers_names_and_code_keep_their_order_from_right_to_left(
    opens: Opens, robot: Robot
) -> None:
    page = opens(locale="ar-EG", **PHONE)
    robot.hello["robot"] = "robot-apartment-2"
    goes = {"skill": "navigate_to", "arguments": {"room": "kitchen"}}
    robot.tell(type="talk", kind="heard", turn=1, text="Go to the kitchen.")
    robot.tell(type="talk", kind="decided", turn=1, calls=[goes], stage="reading", confidence=0.97)
    expect(page.locator(".why")).to_contain_text("\u2068navigate_to(kitchen)\u2069")
    direction = "e => getComputedStyle(e).direction"
    assert page.locator(".bubble.mine").evaluate(direction) == "ltr"
    page.locator(".tabs [data-panel=see]").click()
    place = page.locator(".facts strong").last
    expect(place).to_be_visible()
    assert place.evaluate(direction) == "ltr"
    x_then_y = """e => {
        const text = e.firstChild, at = (i) => {
            const range = document.createRange();
            range.setStart(text, i);
            range.setEnd(text, i + 1);
            return range.getBoundingClientRect().left; };
        return at(1) < at(text.data.indexOf(",") + 3); }"""
    assert place.evaluate(x_then_y), "x stands left of y"


def test_the_robots_words_are_the_pages_and_what_stays_english_says_so(
    opens: Opens, robot: Robot
) -> None:
    goes, moves, _ = robot.hello["skills"]
    goes |= {"label": "in ein Zimmer fahren", "language": "de", "description": ""}
    moves |= {"language": "en"}
    robot.hello |= {"words": {"kitchen": "Küche"}, "arguments": {"room": "Zimmer"}}
    page = opens(locale="de")
    own, english = page.locator(".skill").nth(0), page.locator(".skill").nth(1)
    expect(own.locator(".field")).to_contain_text("Zimmer")
    expect(own.locator("option").nth(0)).to_have_text("Küche")
    expect(own.locator("[lang]")).to_have_count(0)
    expect(english.locator("[lang=en]")).to_have_text(
        ["move", "Drive straight ahead, or back.", "distance (m)", "slowly"]
    )
    own.get_by_role("button").click()
    expect(page.locator(".recent button")).to_have_text("in ein Zimmer fahren: Küche")
    call = {"skill": "navigate_to", "arguments": {"room": "kitchen"}}
    robot.tell(type="talk", kind="heard", turn=1, text="Küche!")
    robot.tell(type="talk", kind="decided", turn=1, calls=[call], stage="template", confidence=1)
    expect(page.locator(".notes")).to_have_text("in ein Zimmer fahren: Küche")


def test_health_is_told_in_the_pages_words_and_a_problem_as_it_is(
    opens: Opens, robot: Robot
) -> None:
    page = opens(locale="de")
    page.locator(".side-switch [data-panel=know]").click()
    lines = page.locator(".diagnostic summary")
    expect(lines).to_have_text(
        ["Mikrofon und LautsprecherOK", "Sprachmodellslow: 9 tokens/s", "RoboterOK"]
    )
    expect(lines.locator("[lang=en]")).to_have_text(["slow: 9 tokens/s"])


def test_an_answer_says_whether_the_model_gave_it(opens: Opens, robot: Robot) -> None:
    page = opens(locale="de")
    robot.tell(type="talk", kind="heard", turn=1, text="Who are you?")
    robot.tell(type="talk", kind="response", turn=1, text="A robot.")
    robot.tell(type="talk", kind="turn_ended", turn=1, outcome="answered", stage="model")
    robot.tell(type="talk", kind="heard", turn=2, text="Fly")
    robot.tell(type="talk", kind="turn_ended", turn=2, outcome="not_understood", stage=None)
    expect(page.locator(".notes")).to_have_text(
        ["Beantwortet · durch das Modell", "Nicht verstanden"]
    )


def test_words_of_others_are_never_markup(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.tell(type="talk", kind="heard", turn=1, text="<img src=x onerror=alert(1)><b>hi")
    expect(page.locator(".bubble.mine")).to_have_text("<img src=x onerror=alert(1)><b>hi")
    assert page.locator(".bubble img").count() == 0


def test_a_question_has_a_yes_and_a_no(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.tell(type="talk", kind="asked", turn=1, text="Shall I go?", expires_s=10)
    yes = page.get_by_role("button", name="Yes")
    yes.wait_for()
    settled(page)
    yes.click()
    robot.tell(type="talk", kind="asked", turn=1, text="", open=False)
    expect(page.locator(".question")).to_be_hidden()
    assert [one["yes"] for one in robot.commands("answer")] == [True]


def test_a_countdown_shows_its_time_and_can_be_ended(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.tell(type="talk", kind="asked", turn=1, text="I will go.", expires_s=1.0, goes=True)
    expect(page.locator(".question")).to_contain_text("I will go. (1 s)")
    settled(page)
    page.get_by_role("button", name="No").click()
    until(page, lambda: robot.commands("answer"))
    assert [one["yes"] for one in robot.commands("answer")] == [False]


def test_a_form_sends_typed_arguments_and_can_be_repeated(opens: Opens, robot: Robot) -> None:
    page = opens()
    form = page.locator(".skill", has_text="Drive straight")
    form.locator("input").fill("1.5")
    form.get_by_role("button").click()
    page.locator(".recent button").click()
    until(page, lambda: len(robot.commands("skill")) == 2)
    wanted = {"distance_m": 1.5, "slowly": False}
    assert [one["arguments"] for one in robot.commands("skill")] == [wanted, wanted]


def test_fields_that_may_stay_empty_are_folded_beside_one_that_may_not(
    opens: Opens, robot: Robot
) -> None:
    fields = {"name": {"type": "string"}, "x": {"anyOf": [{"type": "number"}, {"type": "null"}]}}
    schema = {"type": "object", "required": ["name"], "properties": fields}
    robot.hello["skills"] = [{"name": "remember_place", "schema": schema}]
    page = opens()
    name, x = page.get_by_label("name", exact=True), page.get_by_label("x", exact=True)
    name.fill("dock")
    expect(x).to_be_hidden()
    page.locator(".options summary").click()
    x.fill("2")
    page.locator(".skill button[type=submit]").click()
    until(page, lambda: bool(robot.commands("skill")))
    assert robot.commands("skill")[0]["arguments"] == {"name": "dock", "x": 2}


def test_stop_is_no_form_among_others(opens: Opens, robot: Robot) -> None:
    robot.hello["skills"].append({"name": "stop", "label": "stop at once", "schema": {}})
    page = opens()
    expect(page.locator(".skill h2")).to_have_text(["go to a room", "move", "forget a place"])


def test_a_form_holds_to_the_limits_of_the_policy(opens: Opens, robot: Robot) -> None:
    page = opens()
    form = page.locator(".skill", has_text="Drive straight")
    form.locator("input").fill("9")
    form.get_by_role("button").click()
    assert form.locator("input").evaluate("e => e.validity.rangeOverflow")
    assert not robot.commands("skill")
    forbidden = page.locator(".skill", has_text="Forget a place").get_by_role("button")
    expect(forbidden).to_be_disabled()


def test_a_point_of_the_map_is_chosen_by_keyboard_and_told_by_its_room(
    opens: Opens, robot: Robot
) -> None:
    robot.hello["words"] = {"kitchen": "Küche"}
    page = opens(locale="de")
    canvas, where = page.get_by_role("application", name="Karte"), page.locator(".tap-sheet strong")
    kitchen = page.locator(".map-rooms").get_by_role("button", name="Küche")
    kitchen.focus()
    expect(kitchen).to_have_css("opacity", "1")
    page.keyboard.press("Enter")
    expect(where).to_have_text("Küche · Bei 7,90, 1,90 m")
    page.keyboard.press("Escape")
    expect(canvas).to_be_focused()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(where).to_contain_text("living room · ")


def test_a_tap_on_the_map_goes_there_or_names_it(opens: Opens, robot: Robot) -> None:
    page = opens()
    canvas = page.locator(".map")
    page.locator(".facts .fact").first.wait_for()  # what they take of the map's height is taken
    canvas.click()  # its middle
    page.get_by_role("button", name="Go there").click()
    until(page, lambda: bool(robot.commands("goto")))
    assert robot.commands("goto")[0]["x"] == pytest.approx(5, abs=0.1)
    assert robot.commands("goto")[0]["y"] == pytest.approx(5, abs=0.1)
    page.locator(".tap-sheet").wait_for(state="hidden")
    canvas.focus()
    page.keyboard.press("Enter")
    page.get_by_label("Name of this place").fill("door")
    page.keyboard.press("Enter")
    until(page, lambda: bool(robot.commands("name_place")))
    assert robot.commands("name_place")[0]["name"] == "door"
    sheet, named = page.locator(".tap-sheet"), {"kind": "skill_goal", "skill": "remember_place"}
    robot.tell(
        type="event", **named, status="rejected", error="it is known", why="das kenne ich",
        arguments_json='{"name": "door", "x": 5.0, "y": 5.0}',
    )  # fmt: skip
    expect(page.locator(".toast")).to_have_text("Refused: das kenne ich")
    expect(sheet).to_be_visible()  # for another name
    page.get_by_label("Name of this place").fill("gate")
    page.keyboard.press("Enter")
    until(page, lambda: len(robot.commands("name_place")) == 2)
    robot.tell(type="event", **named, status="succeeded", arguments={"name": "gate"})
    expect(page.locator(".toast.good")).to_have_text(page_words("place_kept", name="gate"))
    expect(sheet).to_be_hidden()
    expect(canvas).to_be_focused()


@pytest.mark.parametrize("can", ["goto", "name_place"])
def test_a_tap_offers_what_the_robot_can(opens: Opens, robot: Robot, can: str) -> None:
    robot.hello["capabilities"] |= {"goto": can == "goto", "name_place": can == "name_place"}
    page = opens()
    page.locator(".map").focus()
    page.keyboard.press("Enter")
    sheet = page.get_by_role("dialog", name=page_words("this_point"))
    expect(sheet).to_be_visible()
    go, name = sheet.get_by_role("button", name="Go there"), sheet.get_by_role("textbox")
    expect(go if can == "goto" else name).to_be_focused()
    expect(name if can == "goto" else go).to_be_hidden()
    page.keyboard.press("Escape")
    expect(sheet).to_be_hidden()


def test_the_map_is_painted(opens: Opens, robot: Robot) -> None:
    page = opens()
    count = """e => {
        const data = e.getContext("2d").getImageData(0, 0, e.width, e.height).data;
        const seen = new Set();
        for (let i = 0; i < data.length; i += 4)
            seen.add(data[i] * 65536 + data[i + 1] * 256 + data[i + 2]);
        return seen.size; }"""
    until(page, lambda: page.locator(".map").evaluate(count) > 20)


def test_a_setting_is_sent_as_what_it_is(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator(".side-switch [data-panel=settings]").click()
    page.get_by_role("switch").press("Enter")
    until(page, lambda: bool(robot.commands("set")))
    assert {k: robot.commands("set")[0][k] for k in ("name", "value")} == {
        "name": "muted",
        "value": True,
    }


def test_a_refusal_says_why(opens: Opens, robot: Robot) -> None:
    robot.answers["text"] = {"message": "no", "reason": "no_lease"}
    page = opens(command=False)
    page.locator(".write input").fill("go")
    page.locator(".write input").press("Enter")
    expect(page.locator(".notes")).to_have_text(page_words("why_no_lease"))


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ({"reason": "invalid", "why": "das ist zu weit"}, "Abgelehnt: das ist zu weit"),
        ({"reason": "invalid"}, page_words("why_invalid", "de")),
        ({"reason": "failed"}, page_words("why_invalid", "de")),
    ],
)
def test_a_refusal_is_in_the_language_of_the_page(
    opens: Opens, robot: Robot, answer: dict, said: str
) -> None:
    robot.answers["text"] = {"message": "that is too far", **answer}
    page = opens(locale="de-DE")
    page.locator(".write input").fill("go")
    page.locator(".write input").press("Enter")
    expect(page.locator(".notes")).to_have_text(said)


def test_without_a_part_for_sound_the_page_says_so_and_works(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.route("**/sound/sound.js", lambda route: route.abort())
    page.get_by_role("button", name=page_words("hear_here")).click()
    expect(page.locator(".sound .small-text")).to_have_text(page_words("sound_failed"))
    page.locator(".write input").fill("go")
    page.locator(".write input").press("Enter")
    until(page, lambda: bool(robot.commands("text")))


def jpeg(shade: int) -> bytes:
    made = io.BytesIO()
    Image.new("RGB", (64, 48), (shade, shade, shade)).save(made, "JPEG")
    return made.getvalue()


def test_the_next_picture_is_asked_for_when_one_is_shown_even_a_broken_one(
    opens: Opens, robot: Robot
) -> None:
    robot.pictures = iter([jpeg(50), b"no picture", jpeg(200)])
    robot.hello = {**HELLO, "capabilities": {"picture": True, "map": False}}
    page = opens()
    expect(page.locator(".picture")).to_be_visible()
    until(page, lambda: robot.asked_pictures == 4)  # one more than there are: it waits


def test_two_browsers_have_one_turn(opens: Opens, robot: Robot) -> None:
    first, second = opens(), opens(command=False)
    expect(second.locator(".lease")).to_contain_text(page_words("commands_now", name="client-1"))
    expect(second.locator(".skill button").first).to_be_disabled()
    first.locator(".lease button.on").click()
    first.get_by_role("button", name=page_words("give_back")).click()
    second.locator(".lease button.primary").click()
    expect(second.locator(".skill button").first).to_be_enabled()
    expect(first.locator(".lease")).to_contain_text(page_words("commands_now", name="client-2"))


def test_how_to_trust_the_certificate_is_told_before_anybody_is_let_in(
    browser: Browser, robot: Robot
) -> None:
    page = browser.new_page(locale="fr-FR")
    page.goto(f"{robot.url}/static/ca.html")
    expect(page.locator("h1")).to_have_text(page_words("ca_title", "fr"))
    assert problems(page) == []
    page.goto(robot.url)
    page.locator(".pair").wait_for()
    expect(page.locator("a[href='/ca']")).to_be_hidden()  # on plain HTTP there is none
    page.close()


def test_an_arm_has_no_map_but_joints_a_hand_and_things(opens: Opens, robot: Robot) -> None:
    robot.scene = {"version": 1}
    robot.hello = {**HELLO, "capabilities": {"picture": False, "drive": False}}
    robot.live = {
        "velocity": None,
        "goal": None,
        "joints": [{"name": "joint1", "value": 0.5, "lower": -2.9, "upper": 2.9}],
        "hand": {"open": 0.1, "holding": "red cube"},
        "things": [{"name": "red cube", "x": 0.5, "y": 0.1, "z": 0.2, "held": True}],
    }
    page = opens()
    expect(page.locator(".joint")).to_contain_text("0.50")
    expect(page.locator(".facts")).to_contain_text("red cube")
    expect(page.locator(".map-card")).to_be_hidden()


def test_a_robot_that_only_talks_has_no_map_and_no_stick(opens: Opens, robot: Robot) -> None:
    robot.live = None
    robot.hello = {**HELLO, "capabilities": {"map": False, "picture": False, "drive": False}}
    page = opens()
    expect(page.locator(".map-card")).to_be_hidden()
    expect(page.locator(".joystick")).to_be_hidden()


@pytest.mark.parametrize("language", LANGUAGES)
def test_each_language_is_whole(language: str) -> None:
    english, its = (
        json.loads((PAGE / f"languages/{one}.json").read_text()) for one in ("en", language)
    )
    assert its.keys() == english.keys()
    assert all(text.strip() for text in its.values())


def test_every_key_that_the_page_says_has_words() -> None:
    said = set()
    for path in PAGE.glob("*.js"):
        said |= set(re.findall(r"\bsay\(\"(\w+)\"", path.read_text(encoding="utf-8")))
    assert said
    said |= {f"outcome_{one}" for one in Outcome if one is not Outcome.ACTED}
    said |= {f"stage_{one}" for one in ("template", "reading", "model", "command", "program")}
    said |= {f"state_{one}" for one in (*State, "moving", "stopped", "gone", "waiting")}
    said |= {f"part_{one}" for one in ComponentName}
    assert said <= json.loads((PAGE / "languages/en.json").read_text()).keys()


@pytest.mark.parametrize("language", ["ar", "de", pytest.param("ja", marks=pytest.mark.long)])
def test_a_phone_in_another_language_needs_no_scrolling_aside(
    opens: Opens, robot: Robot, language: str
) -> None:
    page = opens(locale=language, **PHONE)
    assert page.locator("html").get_attribute("lang") == language
    for part in ("talk", "see", "do", "know", "settings"):
        page.locator(f".tabs [data-panel={part}]").click()
        wide = page.evaluate("document.documentElement.scrollWidth - innerWidth")
        assert wide <= 0


@pytest.mark.parametrize(("device", "colours"), DEVICES)
def test_axe_finds_nothing(opens: Opens, robot: Robot, device: dict, colours: str) -> None:
    page = opens(**device, color_scheme=colours)
    robot.tell(type="talk", kind="heard", turn=1, text="Kitchen!")
    robot.tell(type="talk", kind="response", turn=1, text="Going.", detail="A list.")
    robot.tell(type="talk", kind="asked", turn=1, text="Shall I go?")
    robot.tell(type="stop", engaged=True, by="Ada")
    expect(page.locator(".stopped")).to_be_visible()
    for part in ("do", "know", "settings", "see", "talk"):
        page.locator(f"[data-panel={part}].tab:visible, .panel.{part}:visible").first.click()
        assert problems(page) == []


def test_all_of_the_page_is_small() -> None:
    files = [p for p in PAGE.rglob("*") if p.is_file()]
    assert sum(len(gzip.compress(p.read_bytes())) for p in files) < 200_000


def test_a_long_name_leaves_the_page_as_wide_as_the_phone(opens: Opens, robot: Robot) -> None:
    robot.hello["robot"] = "robot-apartment-of-the-second-floor"
    page = opens(**PHONE)
    page.locator(".chip.battery").wait_for()
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert page.locator(".lease button.on").bounding_box()["x"] < 390


@pytest.mark.parametrize(
    "part",
    ["store.js", pytest.param("style/all.css", marks=pytest.mark.long)],
)
def test_a_page_whose_parts_did_not_all_come_is_loaded_again(
    opens: Opens, robot: Robot, part: str
) -> None:
    robot.breaks = [f"/{part}"]
    page = opens(command=False, locale="de-DE")
    until(page, lambda: robot.loads == 2)
    page.locator("html[data-link=ready]").wait_for()
