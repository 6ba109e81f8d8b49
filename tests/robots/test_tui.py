"""The full-screen terminal, driven as a person would, on a screen of 80 x 24."""

import asyncio
import os
import sys
from contextlib import ExitStack, asynccontextmanager

import phrases
from guards import HUNG_S
from textual.widgets import Footer, Input, RichLog, Static

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.robots import build_body
from edgevox.apps.terminal import prompt
from edgevox.apps.terminal.screen import Face, stderr_as_lines
from edgevox.apps.terminal.slash_commands import SlashContext
from edgevox.apps.terminal.view import UpdateBuffer
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.events import AudioLevel, TokenGenerated, TurnMeasured
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
        return [line.text.strip() for line in self.face.query_one(name, RichLog).lines]

    def panel(self, name):
        return str(self.face.query_one(f"#{name}", Static).render())

    async def until(self, condition):
        async with asyncio.timeout(HUNG_S):
            while not condition():
                await self.pilot.pause()
                await asyncio.sleep(0.01)


@asynccontextmanager
async def screen(size=(80, 24), **queries):
    settings = load_settings({"text_mode": True, "llm": "none"})
    with ExitStack() as stack:
        parts = build_parts(stack, settings, build_body("robot-apartment", settings, 1.0))
        start_parts(stack, parts)
        updates = UpdateBuffer(parts.bus, parts.controls)
        stack.callback(updates.close)
        context = SlashContext(parts.conversation, parts.body, skills=parts.skills)
        asked = {**parts.queries, **queries}
        face = Face(updates, context, asked, parts.command_router.submit, SystemClock())
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


def test_ctrl_c_twice_leaves(monkeypatch):
    monkeypatch.setattr(prompt, "SECOND_CTRL_C_S", HUNG_S)  # keys may come late

    async def play(shown):
        await shown.pilot.press("ctrl+c", "ctrl+c")
        await shown.until(lambda: not shown.face.is_running)

    drive(play)


def test_quit_leaves():
    async def play(shown):
        await shown.type("/quit")
        await shown.until(lambda: not shown.face.is_running)

    drive(play)


def test_slash_commands_answer_into_the_transcript():
    async def play(shown):
        await shown.type("/dance")
        await shown.until(lambda: any("unknown command" in x for x in shown.transcript()))
        await shown.pilot.press("f1")
        await shown.until(lambda: any("/help" in x for x in shown.transcript()))

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
