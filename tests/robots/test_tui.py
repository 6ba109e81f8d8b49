"""The full-screen terminal, driven as a person would, on a screen of 80 x 24."""

import asyncio
import os
import sys
from contextlib import ExitStack, asynccontextmanager

import phrases
import pytest
from guards import HUNG_S
from ports import free_port
from textual.filter import ANSIToTruecolor, DimFilter
from textual.widgets import Footer, Input, RichLog, Static

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.robots import build_body
from edgevox.apps.terminal.hints import example_command, first_hint
from edgevox.apps.terminal.screen import Face, stderr_as_lines
from edgevox.apps.terminal.slash_commands import SlashContext
from edgevox.apps.terminal.view import UpdateBuffer
from edgevox.apps.terminal.widgets import SHEET_FRAME, has_light_background
from edgevox.core.bus import Bus
from edgevox.core.events import AudioLevel, TokenGenerated, TurnMeasured
from edgevox.core.languages import CODES
from edgevox.core.settings import load_settings


class Screen:
    """The interface with an agent behind it, and a person's fingers."""

    def __init__(self, face, pilot, parts, updates):
        self.face, self.pilot, self.parts, self.updates = face, pilot, parts, updates

    async def type(self, line):
        self.face.query_one(Input).value = line
        await self.pilot.press("enter")

    def transcript(self):
        return self.lines_of("#transcript")

    def log(self):
        return self.lines_of("#log")

    def lines_of(self, name):
        lines = self.face.screen_stack[0].query_one(name, RichLog).lines
        return [line.text.strip() for line in lines]

    def panel(self, name):
        return str(self.face.screen_stack[0].query_one(f"#{name}", Static).render())

    def sheet(self):
        """The text of the sheet over it; empty if there is none."""
        found = self.face.screen.query("#sheet")
        return str(found.first(Static).render()) if found else ""

    def foot(self):
        return list(self.face.query("FooterKey"))

    async def until(self, condition):
        async with asyncio.timeout(HUNG_S):
            while not condition():
                await self.pilot.pause()
                await asyncio.sleep(0.01)


@asynccontextmanager
async def screen(size=(80, 24), stopped_by="", settings=None, robot="robot-apartment", **queries):
    settings = load_settings({"text_mode": True, "llm": "none", **(settings or {})})
    with ExitStack() as stack:
        parts = build_parts(stack, settings, build_body(robot, settings, 1.0))
        start_parts(stack, parts)
        if stopped_by:
            parts.software_stop.stop(stopped_by)
        updates = UpdateBuffer(parts.bus, parts.controls)
        stack.callback(updates.close)
        context = SlashContext(
            parts.conversation,
            parts.body,
            skills=parts.skills,
            software_stop=parts.software_stop,
            settings=settings,
        )
        asked = {**parts.queries, **queries}
        for line in first_hint(parts):
            updates.write(line)
        face = Face(updates, context, asked, parts.command_router.submit, name=parts.name)
        async with face.run_test(size=size) as pilot:
            yield Screen(face, pilot, parts, updates)
        updates.changed = lambda: None


def drive(play, **options):
    async def run():
        async with screen(**options) as shown:
            await play(shown)

    asyncio.run(run())


def test_a_typed_line_is_shown_once_and_answered():
    async def play(shown):
        await shown.type("where are you?")
        await shown.until(
            lambda: any(phrases.stands(room="living_room") in x for x in shown.transcript())
        )
        assert shown.transcript().count("> where are you?") == 1

    drive(play)


def test_the_running_skill_and_its_progress_stand_below_the_transcript():
    async def play(shown):
        await shown.type("go to the kitchen")
        await shown.until(lambda: "navigate_to room=kitchen" in shown.panel("status"))
        await shown.pilot.press("ctrl+c")
        await shown.until(lambda: "navigate_to" not in shown.panel("status"))
        await shown.until(lambda: "listening" in shown.panel("state"))

    drive(play)


def test_an_answer_is_seen_while_it_is_generated():
    async def play(shown):
        shown.parts.bus.publish(TokenGenerated("Once upon a", 1))
        await shown.until(lambda: "Once upon a" in shown.panel("status"))

    drive(play)


def test_what_is_loaded_late_stands_in_the_side_panel_after_a_turn():
    loaded = {"stt": {}, "llm": {}, "tts": {}}

    async def play(shown):
        await shown.until(lambda: "tts none" in shown.panel("machine"))
        loaded["tts"] = {"backend": "piper"}
        shown.parts.bus.publish(TurnMeasured(0.41, 0.72, 0.13, 1.25, 3.5))
        await shown.until(lambda: "tts piper" in shown.panel("machine"))

    drive(play, model_info=lambda: dict(loaded))


def test_level_latencies_models_and_machine_stand_in_the_side_panel():
    async def play(shown):
        shown.parts.bus.publish(AudioLevel(0.1))
        shown.parts.bus.publish(TurnMeasured(0.41, 0.72, 0.13, 1.25, 3.5))
        await shown.until(lambda: "▮" in shown.panel("level"))
        await shown.until(lambda: "0.41 0.72 0.13 1.25   3.5" in shown.panel("turns"))
        shown.parts.bus.publish(TurnMeasured(2.47, 48.29, 1.87, 71.31, 73.4))
        await shown.until(lambda: "2.47 48.3 1.87 71.3  73.4" in shown.panel("turns"))
        await shown.until(lambda: "llm none" in shown.panel("machine"))
        assert "ram" in shown.panel("machine")
        assert "language en" in shown.panel("voice")

    drive(play)


def test_a_key_mutes_and_the_screen_says_so():
    async def play(shown):
        await shown.pilot.press("ctrl+t")
        await shown.until(lambda: "muted" in shown.panel("state"))
        assert shown.parts.controls.muted
        await shown.pilot.press("ctrl+t")
        await shown.until(lambda: "muted" not in shown.panel("state"))

    drive(play)


def test_ctrl_c_stops_however_often_it_is_pressed_and_only_ctrl_q_leaves():
    async def play(shown):
        await shown.type("go to the kitchen")
        await shown.until(lambda: "navigate_to room=kitchen" in shown.panel("status"))
        await shown.pilot.press("ctrl+c", "ctrl+c", "ctrl+c")
        await shown.until(lambda: "navigate_to" not in shown.panel("status"))
        await shown.until(lambda: any("Ctrl-Q exits" in x for x in shown.transcript()))
        assert len([x for x in shown.transcript() if "Ctrl-Q exits" in x]) == 1
        assert shown.face.is_running
        await shown.type("where are you?")
        await shown.until(lambda: any("get_pose" in x for x in shown.transcript()))
        await shown.pilot.press("ctrl+q")
        await shown.until(lambda: not shown.face.is_running)

    drive(play)


def test_a_software_stop_stands_over_the_whole_width_until_it_is_lifted():
    async def play(shown):
        line = shown.face.query_one("#stop")
        assert not line.display
        shown.parts.software_stop.stop("Anna's phone")
        await shown.until(lambda: line.display)
        assert "STOPPED by Anna's phone" in shown.panel("stop")
        assert "/resume" in shown.panel("stop")
        await shown.until(lambda: line.region.width == 80)
        await shown.until(lambda: "[stopped by Anna's phone]" in shown.transcript())
        await shown.type("/resume")
        await shown.until(lambda: not shown.parts.software_stop.state.engaged)
        await shown.until(lambda: not line.display)
        assert shown.parts.software_stop.state.by == "the terminal"
        await shown.type("/resume")
        await shown.until(
            lambda: any("No software stop is in force" in x for x in shown.transcript())
        )

    drive(play)


def test_a_software_stop_that_was_in_force_before_is_shown():
    async def play(shown):
        assert "STOPPED by the night watch" in shown.panel("stop")

    drive(play, stopped_by="the night watch")


def test_ctrl_c_stops_the_robot_while_help_is_open():
    async def play(shown):
        await shown.type("go to the kitchen")
        await shown.until(lambda: "navigate_to room=kitchen" in shown.panel("status"))
        await shown.pilot.press("f1", "ctrl+c")
        await shown.until(lambda: "navigate_to" not in shown.panel("status"))
        assert shown.sheet()

    drive(play)


def test_help_is_a_screen_of_its_own_that_names_commands_and_keys():
    async def play(shown):
        await shown.until(lambda: len(shown.transcript()) > 1)
        before = shown.transcript()
        for key in ("f1", "/help"):
            await (shown.pilot.press(key) if key == "f1" else shown.type(key))
            await shown.until(shown.sheet)
            for told in ("/resume", "Ctrl-C", "Ctrl-P", "F2", "F3", "F5", "Up, Down", "Tab"):
                assert told in shown.sheet()
            await shown.pilot.press("f1" if key == "f1" else "escape")
            await shown.until(lambda: not shown.sheet())
        assert shown.transcript() == before

    drive(play)


def test_help_that_is_too_long_for_the_screen_scrolls():
    async def play(shown):
        await shown.pilot.press("f1")
        await shown.until(shown.sheet)
        text = shown.face.screen.query_one("#sheet").parent
        rows = [row for row in shown.sheet().splitlines() if row.startswith("  ")]
        assert all(len(row) <= 40 - SHEET_FRAME for row in rows)
        assert any(row.startswith(" " * 8) for row in rows)
        await shown.pilot.press("pagedown", "pagedown", "pagedown", "pagedown", "pagedown")
        await shown.until(lambda: text.scroll_y == text.max_scroll_y > 0)

    drive(play, size=(40, 15))


def test_the_palette_finds_commands_and_keys_and_stop_works_in_it():
    async def play(shown):
        async def choose(words):
            await shown.pilot.press("ctrl+p")
            await shown.until(lambda: shown.face.screen.query("CommandInput"))
            await shown.pilot.press(*words)
            await shown.until(lambda: found() and words in found()[0])
            await shown.pilot.press("enter")

        def found():
            options = shown.face.screen.query_one("CommandList").options
            return [str(one.prompt) for one in options if not one.disabled]

        await choose("state")
        await shown.until(lambda: any('"battery' in x for x in shown.transcript()))
        await choose("Mute")
        await shown.until(lambda: shown.parts.controls.muted)
        await shown.type("go to the kitchen")
        await shown.until(lambda: "navigate_to room=kitchen" in shown.panel("status"))
        await shown.pilot.press("ctrl+p", "ctrl+c")
        await shown.until(lambda: "navigate_to" not in shown.panel("status"))
        assert shown.face.screen.query("CommandInput")

    drive(play)


def test_up_and_down_bring_back_what_was_typed_and_keep_what_is_begun():
    async def play(shown):
        line = shown.face.query_one(Input)
        await shown.type("where are you?")
        await shown.type("/state")
        line.value = "go to"
        seen = []
        for key in ("up", "up", "up", "down", "down"):
            await shown.pilot.press(key)
            seen.append(line.value)
        assert seen == ["/state", "where are you?", "where are you?", "/state", "go to"]

    drive(play)


def test_an_endless_line_does_not_come_back():
    async def play(shown):
        await shown.type("/" + "x" * 3000)
        await shown.type("/state")
        await shown.pilot.press("up", "up")
        assert shown.face.query_one(Input).value == "/state"

    drive(play)


def test_tab_completes_a_thing():
    async def play(shown):
        await shown.pilot.press(*"grasp the re")
        while shown.face.query_one(Input).value != "grasp the red cube":
            await shown.pilot.press("tab")
            shown.face.query_one(Input).focus()

    drive(play, robot="robot-panda")


@pytest.mark.parametrize(
    ("begun", "whole"),
    [("/res", "/resume"), ("go to the ki", "go to the kitchen"), ("Where a", "Where are you?")],
)
def test_tab_completes_a_command_a_place_and_what_was_typed_before(begun, whole):
    async def play(shown):
        line = shown.face.query_one(Input)
        await shown.type("where are you?")
        await shown.pilot.press(*begun)
        await shown.until(lambda: line.value == begun)

        async def completed():
            await shown.pilot.press("tab")
            line.focus()

        while line.value != whole:  # a suggestion comes a moment later
            await completed()
        assert line.value == whole

    drive(play)


def test_lines_wrap_anew_with_their_width():
    long = "word " * 30

    async def play(shown):
        def rows():
            return [x for x in shown.transcript() if x.startswith("word")]

        shown.updates.write(long)
        await shown.until(rows)
        beside = len(rows())
        await shown.pilot.press("f2")
        await shown.until(lambda: len(rows()) < beside)
        wide = len(rows())
        await shown.pilot.resize_terminal(40, 24)
        await shown.until(lambda: len(rows()) > wide)
        narrow = len(rows())
        await shown.pilot.resize_terminal(200, 24)
        await shown.until(lambda: len(rows()) < narrow)
        assert len(rows()) == 1
        assert " ".join(rows()).split() == long.split()

    drive(play)


def test_the_log_is_as_wide_as_the_screen_however_that_changes():
    async def play(shown):
        shown.updates.log("x" * 150)
        await shown.pilot.press("f3")
        await shown.until(lambda: "x" * 150 in shown.log())
        await shown.pilot.resize_terminal(80, 24)
        await shown.until(lambda: "x" * 150 not in shown.log())
        await shown.pilot.resize_terminal(160, 50)
        await shown.until(lambda: "x" * 150 in shown.log())

    drive(play, size=(160, 50))


def test_a_traceback_of_the_log_is_folded_to_its_error_until_a_key_shows_it():
    trace = [
        "  Traceback (most recent call last):",
        '    File "robot.py", line 3, in drive',
        "      raise ValueError",
        "  ValueError: no wheels",
    ]

    async def play(shown):
        for line in ("before", *trace, "after"):
            shown.updates.log(line)
        await shown.pilot.press("f3")
        await shown.until(lambda: "after" in shown.log())
        folded = shown.log()
        assert folded[0] == "before"
        assert folded[1].startswith(trace[0].strip())
        assert folded[2:] == ["ValueError: no wheels", "after"]
        await shown.pilot.press("f5")
        await shown.until(
            lambda: shown.log() == ["before", *(one.strip() for one in trace), "after"]
        )
        await shown.pilot.press("f5")
        await shown.until(lambda: shown.log() == folded)

    drive(play)


def test_the_panel_hides_on_a_narrow_screen_and_a_line_tells_the_robot():
    async def play(shown):
        side, bar = shown.face.query_one("#side"), shown.face.query_one("#bar")
        await shown.until(lambda: bar.display and not side.display)
        await shown.until(lambda: "living room 4.3, 0.8 m" in shown.panel("bar"))
        assert "listening" in shown.panel("bar")
        assert "100%" in shown.panel("bar")
        assert shown.face.query_one("#transcript").region.width == 40
        await shown.until(lambda: len(shown.foot()) == 3)
        whole = shown.face.screen.region
        assert all(whole.contains_region(one.region) for one in shown.foot())
        await shown.pilot.resize_terminal(80, 24)
        await shown.until(lambda: side.display and not bar.display)
        await shown.until(lambda: len(shown.foot()) == 7)
        assert all(one.region.right <= 80 for one in shown.foot())
        await shown.pilot.press("f2")
        await shown.until(lambda: bar.display and not side.display)

    drive(play, size=(40, 15))


def test_the_robot_its_place_and_battery_stand_in_the_panel_and_a_map_where_there_is_room():
    async def play(shown):
        await shown.until(lambda: "living room 4.3, 0.8 m" in shown.panel("robot"))
        assert "robot-apartment" in shown.panel("robot")
        assert "battery 100%" in shown.panel("robot")
        await shown.until(lambda: "kitchen" in shown.panel("map"))
        side = shown.face.query_one("#side")
        assert side.region.contains_region(shown.face.query_one("#map").region)
        assert side.max_scroll_y == 0

    drive(play, size=(160, 50))


def test_the_first_lines_say_what_to_try_and_how_to_stop():
    async def play(shown):
        await shown.until(lambda: "Ctrl-C stops the robot" in " ".join(shown.transcript()))
        hint = shown.transcript()[0]
        await shown.type(hint.partition(": ")[2].rstrip("."))
        await shown.until(lambda: "navigate_to room=kitchen" in shown.panel("status"))

    drive(play)


@pytest.mark.parametrize("language", CODES)
@pytest.mark.parametrize(
    ("robot", "skill"),
    [
        ("robot-apartment", "navigate_to"),
        ("robot-panda", "grasp"),
        ("robot-humanoid", "walk_forward"),
    ],
)
def test_the_example_is_in_the_robots_language_and_understood(robot, skill, language):
    settings = load_settings({"text_mode": True, "llm": "none", "language": language})
    with ExitStack() as stack:
        parts = build_parts(stack, settings, build_body(robot, settings, 1.0))
        example = example_command(parts.conversation, parts.skills)
        meaning = parts.conversation.interpreter.plain(example)
    assert [call.skill for call in meaning.calls] == [skill]


def test_a_turns_understanding_and_outcome_stand_below_it():
    async def play(shown):
        await shown.type("where are you?")
        told = "· acted: get_pose() by template, 100% sure"
        await shown.until(lambda: told in shown.transcript())

    drive(play)


def test_a_key_changes_between_light_and_dark():
    async def play(shown):
        before = shown.face.screen.styles.background
        await shown.pilot.press("f4")
        await shown.until(lambda: shown.face.screen.styles.background != before)
        await shown.pilot.press("f4")
        await shown.until(lambda: shown.face.screen.styles.background == before)

    drive(play)


@pytest.mark.parametrize(
    ("told", "light"), [("", False), ("15;0", False), ("0;15", True), ("0;default;7", True)]
)
def test_a_light_terminal_is_known_by_what_it_says_of_itself(told, light):
    assert has_light_background(told) is light


@pytest.mark.parametrize("size", [(160, 50), (80, 24), (40, 15)])
@pytest.mark.parametrize("keys", [(), ("f4",)], ids=["dark", "light"])
def test_all_text_is_legible(size, keys):
    async def play(shown):
        shown.parts.software_stop.stop("Anna")
        shown.parts.bus.publish(AudioLevel(0.1))
        await shown.type("where are you?")
        await shown.until(lambda: any("get_pose" in x for x in shown.transcript()))
        await shown.until(lambda: "listening" in shown.panel("state"))
        await shown.pilot.press(*keys, *"go to the ki")
        await shown.pilot.pause()
        assert any("listening" in text for text, _ in contrasts(shown.face))
        for number in range(8):
            shown.updates.log(f"\x1b[2mtime\x1b[0m \x1b[3{number}m\x1b[1mcolour {number}\x1b[0m")
        await shown.pilot.press("f3")
        await shown.until(lambda: any("colour 7" in text for text, _ in contrasts(shown.face)))
        for more in ((), ("f1",), ("f1", "ctrl+p")):
            await shown.pilot.press(*more)
            await shown.pilot.pause()
            assert not {
                (text, round(ratio, 2))
                for text, ratio in contrasts(shown.face)
                if ratio < 4.5 and any(one.isalnum() for one in text)
            }

    drive(play, size=size)


def contrasts(face):
    """Every text on the screen, and its contrast to its background (WCAG)."""
    for widget in face.screen.walk_children():
        if not widget.display or not widget.region:
            continue
        for y in range(widget.size.height):
            on = widget.background_colors[1]
            coloured = ANSIToTruecolor(face.ansi_theme).apply(list(widget.render_line(y)), on)
            for segment in DimFilter().apply(coloured, on):
                style = segment.style
                if segment.text.strip() and style and style.color and style.bgcolor:
                    colours = (style.color.triplet, style.bgcolor.triplet)
                    if all(colours):
                        light, dark = sorted(map(luminance, colours), reverse=True)
                        yield segment.text.strip(), (light + 0.05) / (dark + 0.05)


def luminance(colour):
    shares = [one / 255 for one in colour]
    red, green, blue = (
        one / 12.92 if one <= 0.04045 else ((one + 0.055) / 1.055) ** 2.4 for one in shares
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def test_quit_leaves():
    async def play(shown):
        await shown.type("/quit")
        await shown.until(lambda: not shown.face.is_running)

    drive(play)


def test_slash_commands_answer_into_the_transcript():
    async def play(shown):
        await shown.type("/dance")
        await shown.until(lambda: any("unknown command" in x for x in shown.transcript()))

    drive(play)


def test_everything_has_its_place_on_80_by_24_and_the_panel_can_go():
    async def play(shown):
        whole = shown.face.screen.region
        for widget in (shown.face.query_one(kind) for kind in ("#transcript", Input, Footer)):
            assert whole.contains_region(widget.region)
            assert widget.region.area > 0
        assert whole.contains_region(shown.face.query_one("#machine").region)
        before = shown.face.query_one("#transcript").region.width
        await shown.pilot.press("f2")
        await shown.until(lambda: shown.face.query_one("#transcript").region.width > before)

    drive(play)


def test_the_log_has_a_place_of_its_own_and_a_key_shows_it():
    async def play(shown):
        shown.updates.log("\x1b[31merror\x1b[0m the disk is full")
        shown.updates.log("a line of a library")
        await shown.until(lambda: "log: 2 new, F3" in shown.panel("unread"))
        assert not shown.face.query_one("#log").display
        assert not any("disk" in line for line in shown.transcript())
        await shown.pilot.press("f3")
        await shown.until(lambda: "error the disk is full" in shown.log())
        assert shown.log().count("a line of a library") == 1
        assert shown.panel("unread") == ""
        log, whole = shown.face.query_one("#log").region, shown.face.screen.region
        assert log.height > 4
        assert whole.contains_region(log)
        assert shown.face.query_one("#transcript").region.height > 4
        await shown.pilot.press("f3")
        shown.updates.log("later")
        await shown.until(lambda: "log: 1 new, F3" in shown.panel("unread"))

    drive(play)


def test_a_failure_stands_in_the_conversation_once():
    async def play(shown):
        with stderr_as_lines(shown.updates.log):
            await shown.type("go to x 99 y 99")
            await shown.until(lambda: any("could not" in x for x in shown.transcript()))
            await shown.pilot.press("f3")
            os.write(2, b"warning refused\n")
            await shown.until(lambda: "warning refused" in shown.log())
        assert len([x for x in shown.transcript() if "could not" in x]) == 1
        assert not any(x.startswith("!") or "warning" in x for x in shown.transcript())

    drive(play)


def test_a_changed_language_is_seen():
    async def play(shown):
        shown.parts.controls.change({"language": "fr"})
        await shown.until(lambda: "language fr" in shown.panel("voice"))

    drive(play)


def test_what_libraries_write_to_stderr_becomes_lines():
    lines = []
    before = sys.__stderr__
    with stderr_as_lines(lines.append):
        os.write(2, b"from a library in C\nand more")
        assert sys.__stderr__ is not before
    assert lines == ["from a library in C", "and more"]
    assert sys.__stderr__ is before


def test_a_feed_asks_to_be_drawn_once_for_many_events():
    class Controls:
        language, voice, muted = "en", "", False

    bus, asked = Bus(), []
    updates = UpdateBuffer(bus, Controls())
    updates.changed = lambda: asked.append(1)
    for _ in range(100):
        bus.publish(AudioLevel(0.5))
    assert len(asked) == 1
    assert updates.take().level == 0.5
    bus.publish(AudioLevel(0.25))
    assert len(asked) == 2
    updates.close()


def test_a_phone_is_let_in_by_a_picture_that_fits_the_screen(tmp_path):
    console = {"console": True, "console_names": "127.0.0.2", "console_folder": str(tmp_path)}

    async def play(shown):
        await shown.type("/pair")
        await shown.until(lambda: any("/pair open" in line for line in shown.transcript()))
        await shown.type("/pair open")
        await shown.until(lambda: "https://127.0.0.2" in shown.sheet())
        sheet = shown.face.screen.query_one("#sheet")
        assert "&phone" in shown.sheet()
        assert sheet.parent.max_scroll_y == 0

    drive(play, settings={**console, "console_port": free_port()})


def test_a_robot_without_a_console_pairs_no_phone():
    async def play(shown):
        await shown.type("/pair")
        await shown.until(lambda: "This robot serves no console." in shown.transcript())

    drive(play)
