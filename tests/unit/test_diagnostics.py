"""What components say of themselves, from plain values."""

from dataclasses import replace
from pathlib import Path

import pytest

from edgevox.core.bus import Bus
from edgevox.core.events import AudioLevel, Outcome, TokenGenerated, TurnEnded, TurnMeasured
from edgevox.ops.diagnostics import Component, Diagnostics, Finding, Level, component
from edgevox.ops.diagnostics.audio import Sound, audio
from edgevox.ops.diagnostics.disk import MIB, Room, disk, room, rooms
from edgevox.ops.diagnostics.gauges import Gauges
from edgevox.ops.diagnostics.lately import LATELY_S, Lately
from edgevox.ops.diagnostics.llm import Thinking, llm
from edgevox.ops.diagnostics.moving import Executing, World, executor, sim
from edgevox.ops.diagnostics.process import process
from edgevox.ops.diagnostics.speech import Hearing, Speaking, stt, tts
from edgevox.ops.health import STALL_S, Health

GIB = 1024 * MIB


class Clock:
    def __init__(self):
        self.now_s = 0.0

    def now(self):
        return self.now_s


def test_components_are_listed_in_the_order_in_which_they_were_added():
    listed = Diagnostics()
    for name in ("audio", "llm", "audio"):
        listed.add(name, lambda name=name: Component(name, Level.OK, "works"))
    assert [one.name for one in listed.report()] == ["audio", "llm"]


def test_a_look_that_breaks_is_an_error_with_its_reason_and_hides_no_other():
    listed = Diagnostics()
    listed.add("sim", lambda: 1 / 0)
    listed.add("disk", lambda: component("disk"))
    broken, fine = listed.report()
    assert (broken.name, broken.level) == ("sim", Level.ERROR)
    assert "ZeroDivisionError" in broken.message
    assert fine == Component("disk", Level.OK, "works")


def test_the_worst_finding_decides_and_comes_first_and_unknown_values_are_left_out():
    found = [Finding(Level.WARN, "slow"), Finding(Level.ERROR, "stuck")]
    said = component("sim", found, pace=0.51234, muted=True, battery=None)
    assert (said.level, said.message) == (Level.ERROR, "stuck; slow")
    assert said.values == {"pace": "0.5123", "muted": "true"}


def test_what_happened_is_shown_for_a_while_and_then_over():
    clock = Clock()
    lately = Lately(clock)
    assert not lately.grew(0)
    clock.now_s = 100.0
    assert lately.grew(2)
    clock.now_s += LATELY_S - 0.1
    assert lately.grew(2)
    clock.now_s += 0.2
    assert not lately.grew(2)
    assert lately.grew(3)


SOUND = Sound("a microphone", "a loudspeaker")


@pytest.mark.parametrize(
    ("changed", "level", "said"),
    [
        ({}, Level.OK, "hears and speaks"),
        ({"muted": True}, Level.OK, "muted"),
        ({"source_trouble": "unplugged"}, Level.ERROR, "microphone: unplugged"),
        ({"sink_trouble": "unplugged"}, Level.ERROR, "loudspeaker: unplugged"),
        ({"ears": "its thread has ended"}, Level.ERROR, "ears: its thread"),
        ({"dropped": 9, "losing": True}, Level.WARN, "9 by now"),
        ({"dropped": 9}, Level.OK, "hears"),
    ],
)
def test_audio_says_what_is_wrong_with_its_devices(changed, level, said):
    seen = audio(replace(SOUND, **changed))
    assert seen.level is level
    assert said in seen.message
    wrong = "source_trouble" in changed
    assert seen.values["source_state"] == ("retrying" if wrong else "open")


@pytest.mark.parametrize(
    ("changed", "level"),
    [
        ({}, Level.OK),
        ({"last_s": 0.8, "last_sound_s": 0.5}, Level.OK),  # a short word takes what it takes
        ({"last_s": 5.0, "last_sound_s": 2.0}, Level.WARN),
        ({"last_s": 5.0, "last_sound_s": 20.0}, Level.OK),
        ({"refused": 1, "refusing": True}, Level.WARN),
        ({"failed": 1, "failing": True}, Level.ERROR),
        ({"failed": 1}, Level.OK),
    ],
)
def test_speech_to_text_says_when_it_is_slow_flooded_or_failing(changed, level):
    assert stt(Hearing("whisper-tiny.en", "en", **changed)).level is level


def test_speech_to_text_tells_its_real_time_factor():
    said = stt(Hearing("whisper-tiny.en", "en", last_s=0.5, last_sound_s=2.0))
    assert said.values["real_time_factor"] == "0.25"


@pytest.mark.parametrize(
    ("asked", "speaks", "failing", "level"),
    [
        ("piper", None, False, Level.OK),  # nothing is loaded yet
        ("piper", "piper", False, Level.OK),
        ("kokoro", "piper", False, Level.OK),
        ("piper", "espeak", False, Level.WARN),
        ("espeak", "espeak", False, Level.OK),
        ("piper", "piper", True, Level.WARN),
    ],
)
def test_text_to_speech_says_when_another_voice_must_do(asked, speaks, failing, level):
    seen = Speaking("a voice", asked, speaks, speaks, failing=failing)
    assert tts(seen).level is level


@pytest.mark.parametrize(
    ("changed", "level", "answers"),
    [
        ({"model": "a.gguf"}, Level.OK, "on board"),
        ({"model": "a.gguf", "endpoint": "http://llm"}, Level.OK, "endpoint"),
        (
            {"model": "a.gguf", "endpoint": "http://llm", "endpoint_trouble": "refused"},
            Level.WARN,
            "on board",
        ),
        ({"endpoint": "http://llm", "endpoint_trouble": "refused"}, Level.ERROR, "on board"),
        ({"model": "a.gguf", "failed": 1, "failing": True}, Level.ERROR, "on board"),
    ],
)
def test_the_language_model_says_who_answers(changed, level, answers):
    said = llm(Thinking(**changed))
    assert (said.level, said.values["answers"]) == (level, answers)


@pytest.mark.parametrize(
    ("changed", "level"),
    [
        ({}, Level.OK),
        ({"pace": 0.95}, Level.OK),
        ({"pace": 0.5}, Level.WARN),
        ({"real_time_factor": 30.0, "pace": None}, Level.OK),  # as fast as it can
        ({"stalled_s": 2.0}, Level.WARN),
        ({"stalled_s": STALL_S + 1}, Level.ERROR),
        ({"stalled_s": float("inf")}, Level.ERROR),
        ({"breaks": 1, "breaking": True}, Level.ERROR),
        ({"breaks": 1}, Level.OK),
        ({"battery": 0.1}, Level.WARN),
        ({"battery": 0.0}, Level.ERROR),
        ({"trouble": "nothing is heard on /odom"}, Level.ERROR),
    ],
)
def test_a_robot_says_when_its_world_stands_breaks_or_is_slow(changed, level):
    assert sim(World("robot-apartment", **changed)).level is level


@pytest.mark.parametrize(
    ("changed", "level"),
    [
        ({}, Level.OK),
        ({"stalled_s": 1.5}, Level.WARN),
        ({"stalled_s": STALL_S + 1}, Level.ERROR),
        ({"failed": 3, "failing": True}, Level.WARN),
        ({"missing": "rclpy cannot be imported"}, Level.ERROR),
    ],
)
def test_the_executor_says_when_a_callback_holds_up_all_others(changed, level):
    assert executor(Executing(**changed)).level is level


@pytest.mark.parametrize(
    ("free", "size", "level"),
    [
        (20 * GIB, 100 * GIB, Level.OK),
        (GIB // 2, 100 * GIB, Level.WARN),
        (50 * MIB, 100 * GIB, Level.ERROR),
        (60 * MIB, 64 * MIB, Level.OK),  # a container's /tmp is small by design
        (5 * MIB, 64 * MIB, Level.WARN),
        (MIB, 64 * MIB, Level.ERROR),
    ],
)
def test_a_disk_is_full_by_what_is_left_and_a_small_one_by_which_part(free, size, level):
    said = disk([Room(Path("/data"), 1, free, size, writable=True)])
    assert said.level is level
    assert said.values == {"/data free_mib": str(free // MIB)}


def test_each_file_system_that_is_written_to_counts_once(tmp_path):
    (here,) = rooms([tmp_path / "not" / "made" / "yet", tmp_path])
    assert here.path == tmp_path
    assert here.size >= here.free > 0
    sealed = replace(room(tmp_path), writable=False)
    assert list(rooms([tmp_path], lambda _: sealed)) == []
    assert disk([]).message == "nothing is written"


REFUSED = {"too_long": 3, "too_many": 0}


def test_the_process_says_what_its_health_says():
    health = Health()
    health.watch("conversation", lambda: "")
    assert process(health, 0.0, "1", REFUSED).level is Level.WARN
    assert process(health, 0.0, "1", REFUSED).message == "start: starting"
    health.started()
    said = process(health, 0.0, "1", REFUSED)
    assert said.level is Level.OK
    assert int(said.values["memory_mib"]) > 5
    assert (said.values["refused_too_long"], said.values["refused_too_many"]) == ("3", "0")
    health.watch("body", lambda: "has not moved for 7.0 s")
    assert process(health, 0.0, "1", REFUSED).level is Level.ERROR


def test_gauges_keep_the_last_of_what_passed_on_the_bus():
    bus = Bus()
    gauges = Gauges(bus)
    bus.publish(AudioLevel(0.25))
    for _ in range(10):
        bus.publish(TokenGenerated("a ", 1))
    bus.publish(TurnMeasured(stt=0, llm=0.5, tts=0.2, ttfs=0.7, total=1, turn=1))
    bus.publish(TurnEnded(1, Outcome.ANSWERED))
    assert (gauges.level, gauges.tokens_per_s, gauges.first_audio_s) == (0.25, 20.0, 0.7)
    bus.publish(TurnEnded(2, Outcome.FAILED))  # no model had a part in it
    assert gauges.model_failures == 0
    bus.publish(TurnMeasured(stt=0, llm=0.5, tts=0, ttfs=0.7, total=1, turn=3))
    bus.publish(TurnEnded(3, Outcome.FAILED))
    assert gauges.model_failures == 1
    gauges.close()
    bus.publish(AudioLevel(0.5))
    assert gauges.level == 0.25
