"""What components say of themselves, from whatever they are made of."""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from small_disk import small_disk
from support.clock import HeldClock

from edgevox.agent.llm.language_model import LlmComponent
from edgevox.agent.skills import SkillFailed
from edgevox.core.bus import Bus
from edgevox.core.events import AudioLevel, Outcome, TokenGenerated, TurnEnded, TurnMeasured
from edgevox.core.languages import LANGUAGES
from edgevox.core.status import (
    LATELY_S,
    STALL_S,
    Components,
    Finding,
    Gauges,
    HealthCheck,
    Level,
    Off,
    RecentIncrease,
    Status,
)
from edgevox.ops.health import Health
from edgevox.ops.machine import (
    MIB,
    DiskComponent,
    DiskSpace,
    ProcessComponent,
    disk_status,
    room,
    rooms,
    unwritable,
)
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.sim_loop import SimComponent
from edgevox.robots.world.load import load_world
from edgevox.ros2.open import ExecutorComponent, ExecutorCounts
from edgevox.voice.status import AudioComponent, SttComponent, TtsComponent

GIB = 1024 * MIB
CONTROLS = SimpleNamespace(language="en", voice="", muted=False)


class Broken:
    name, checks = "sim", ()

    def status(self):
        raise ZeroDivisionError


def a_while_later(component, clock):
    """What it says once what happened is over."""
    component.status()
    clock.now_s += LATELY_S + 1
    return component.status()


def test_components_are_listed_in_the_order_in_which_they_were_added():
    listed = Components(Off("audio", "text is typed"))
    listed.add(Off("llm", "none was asked for"), Off("audio", "muted for good"))
    said = [(one.name, one.message) for one in listed.statuses()]
    assert said == [("audio", "off: muted for good"), ("llm", "off: none was asked for")]
    assert [one.name for one in listed.statuses({"llm"})] == ["llm"]


def test_a_component_that_breaks_is_an_error_with_its_reason_and_hides_no_other():
    broken, fine = Components(Broken(), Off("disk", "nothing is written")).statuses()
    assert (broken.name, broken.level) == ("sim", Level.ERROR)
    assert "ZeroDivisionError" in broken.message
    assert fine == Status("disk", Level.OK, "off: nothing is written")


def test_the_worst_finding_decides_and_comes_first_and_unknown_values_are_not_shown():
    found = [Finding(Level.WARN, "slow"), Finding(Level.ERROR, "stuck")]
    said = Status.judged("sim", found, pace=0.51234, muted=True, battery=None)
    assert (said.level, said.message) == (Level.ERROR, "stuck; slow")
    assert said.texts == {"pace": "0.5123", "muted": "true"}


def test_what_happened_is_shown_for_a_while_and_then_over():
    clock = HeldClock()
    increase = RecentIncrease(clock)
    assert not increase.grew(0)
    clock.now_s = 100.0
    assert increase.grew(2)
    clock.now_s += LATELY_S - 0.1
    assert increase.grew(2)
    clock.now_s += 0.2
    assert not increase.grew(2)
    assert increase.grew(3)


def sound(clock, *, alive=True, muted=False, source_fault="", sink_fault="", dropped=0, failed=0):
    return AudioComponent(
        SimpleNamespace(name="a microphone", fault=source_fault, dropped=dropped),
        SimpleNamespace(name="a loudspeaker", fault=sink_fault),
        SimpleNamespace(alive=alive, failed=failed),
        SimpleNamespace(alive=alive),
        controls=SimpleNamespace(muted=muted),
        gauges=Gauges(Bus()),
        clock=clock,
    )


@pytest.mark.parametrize(
    ("changed", "level", "said"),
    [
        ({}, Level.OK, "hears and speaks"),
        ({"muted": True}, Level.OK, "muted"),
        ({"source_fault": "unplugged"}, Level.ERROR, "microphone: unplugged"),
        ({"sink_fault": "unplugged"}, Level.ERROR, "loudspeaker: unplugged"),
        (
            {"alive": False},
            Level.ERROR,
            "listener: its thread has ended; speech_output: its thread has ended",
        ),
        ({"dropped": 9}, Level.WARN, "9 by now"),
        ({"failed": 2}, Level.ERROR, "lost for a fault, 2 times by now"),
    ],
)
def test_audio_says_what_is_wrong_with_its_devices(changed, level, said):
    seen = sound(HeldClock(), **changed).status()
    assert seen.level is level
    assert said in seen.message
    wrong = "source_fault" in changed
    assert seen.values["source_state"] == ("retrying" if wrong else "open")


def test_frames_that_were_dropped_some_time_ago_are_only_counted():
    clock = HeldClock()
    seen = a_while_later(sound(clock, dropped=9), clock)
    assert (seen.level, seen.values["dropped_frames"]) == (Level.OK, 9)


def hearing(clock, last=None, *, refused=0, failed=0, fault=""):
    transcriber = SimpleNamespace(last=last, refused=refused, failed=failed)
    listener = SimpleNamespace(transcriber=transcriber)
    return SttComponent(SimpleNamespace(fault=fault), listener, CONTROLS, clock)


@pytest.mark.parametrize(
    ("changed", "level", "later"),
    [
        ({}, Level.OK, Level.OK),
        ({"last": (0.8, 0.5)}, Level.OK, Level.OK),  # a short word takes what it takes
        ({"last": (5.0, 2.0)}, Level.WARN, Level.WARN),
        ({"last": (5.0, 20.0)}, Level.OK, Level.OK),
        ({"refused": 1}, Level.WARN, Level.OK),
        ({"failed": 1}, Level.ERROR, Level.OK),
        ({"fault": "no model"}, Level.ERROR, Level.ERROR),
    ],
)
def test_speech_to_text_says_when_it_is_slow_flooded_or_failing(changed, level, later):
    clock = HeldClock()
    component = hearing(clock, **changed)
    assert component.status().level is level
    assert a_while_later(component, clock).level is later


def test_speech_to_text_tells_its_real_time_factor():
    assert hearing(HeldClock(), (0.5, 2.0)).status().texts["real_time_factor"] == "0.25"


@pytest.mark.parametrize(
    ("asked", "speaks", "failures", "level"),
    [
        ("piper", None, 0, Level.OK),  # nothing is loaded yet
        ("piper", "piper", 0, Level.OK),
        ("kokoro", "piper", 0, Level.OK),
        ("piper", "espeak", 0, Level.WARN),
        ("espeak", "espeak", 0, Level.OK),
        ("piper", "piper", 1, Level.WARN),
    ],
)
def test_text_to_speech_says_when_another_voice_must_do(asked, speaks, failures, level):
    voices = {one.backend: one for row in LANGUAGES.values() for one in row.voices}
    last = (SimpleNamespace(name=speaks, backend=speaks), 16000) if speaks else None
    synthesiser = SimpleNamespace(last=last, failures=failures, fault="")
    language = next(code for code, row in LANGUAGES.items() if voices[asked] in row.voices)
    controls = SimpleNamespace(language=language, voice=voices[asked].name)
    speech_output = SimpleNamespace(synthesiser=synthesiser, refused=0)
    assert TtsComponent(speech_output, controls, Gauges(Bus()), HeldClock()).status().level is level


def thinking(clock=None, *, on_board=False, endpoint="", fault="", failed=0):
    model = SimpleNamespace(fault=fault, context_tokens=4096)
    gauges = SimpleNamespace(model_failures=failed, tokens_per_s=None)
    weights = Path("a.gguf") if on_board else None
    return LlmComponent(model, gauges, weights=weights, endpoint=endpoint, clock=clock)


@pytest.mark.parametrize(
    ("changed", "level", "answers"),
    [
        ({"on_board": True}, Level.OK, "on board"),
        ({"on_board": True, "endpoint": "http://llm"}, Level.OK, "endpoint"),
        (
            {"on_board": True, "endpoint": "http://llm", "fault": "refused"},
            Level.WARN,
            "on board",
        ),
        ({"endpoint": "http://llm", "fault": "refused"}, Level.ERROR, "on board"),
        ({"on_board": True, "failed": 1}, Level.ERROR, "on board"),
    ],
)
def test_the_language_model_says_who_answers(changed, level, answers):
    said = thinking(**changed).status()
    assert (said.level, said.values["answers"]) == (level, answers)


def unheard():
    raise SkillFailed("I hear nothing of battery.")


def robot(clock=None, **changed):
    at_rest = {"real_time_factor": 0.0, "pace": None, "breaks": 0, "stalled_s": 0.0, "fault": ""}
    return SimComponent(SimpleNamespace(name="robot-apartment", **{**at_rest, **changed}), clock)


@pytest.mark.parametrize(
    ("changed", "level"),
    [
        ({}, Level.OK),
        ({"pace": 0.95}, Level.OK),
        ({"pace": 0.5}, Level.WARN),
        ({"real_time_factor": 30.0}, Level.OK),  # as fast as it can
        ({"stalled_s": 2.0}, Level.WARN),
        ({"stalled_s": STALL_S + 1}, Level.ERROR),
        ({"stalled_s": float("inf")}, Level.ERROR),
        ({"breaks": 1}, Level.ERROR),
        ({"battery": lambda: 0.1}, Level.WARN),
        ({"battery": unheard}, Level.OK),
        ({"battery": lambda: 0.0}, Level.ERROR),
        ({"fault": "nothing is heard on /odom"}, Level.ERROR),
    ],
)
def test_a_robot_says_when_its_world_stands_breaks_or_is_slow(changed, level):
    assert robot(**changed).status().level is level


def test_a_world_that_broke_some_time_ago_is_well_and_its_breaks_are_counted():
    clock = HeldClock()
    seen = a_while_later(robot(clock, breaks=1), clock)
    assert (seen.level, seen.values["broke"]) == (Level.OK, 1)


def test_a_world_that_hangs_says_so_and_is_not_waited_for():
    def wait_for_the_step():
        raise AssertionError("the step that hangs holds the lock")

    said = robot(stalled_s=STALL_S + 1, battery=wait_for_the_step).status()
    assert said.message == "the world has not moved for 7.0 s"


def test_a_robot_whose_battery_cannot_be_read_is_in_trouble_and_alive():
    def read():
        raise OSError("no such bus")

    components = Components(robot(battery=read))
    (said,) = components.statuses()
    assert (said.level, "no such bus" in said.message) == (Level.ERROR, True)
    assert Health(components).live().checks == {"body": ""}


class Sticky(PymunkEngine):
    """A world whose steps can be made to hang."""

    def __init__(self, world):
        super().__init__(world)
        self.stuck, self.free = threading.Event(), threading.Event()
        self.free.set()

    def step(self, command):
        if not self.free.is_set():
            self.stuck.set()
            self.free.wait(60)
        return super().step(command)


def test_a_step_that_hangs_keeps_nobody_from_asking_how_its_world_is():
    world = load_world()
    engine = Sticky(world)
    with DiffDriveRobot("robot-apartment", world, engine) as body, ThreadPoolExecutor(1) as asking:
        engine.free.clear()
        body.set_velocity(Twist2D(0.1, 0.0))
        assert engine.stuck.wait(60)
        try:
            assert asking.submit(SimComponent(body).status).result(30).name == "sim"
        finally:
            engine.free.set()


@pytest.mark.parametrize(
    ("seen", "missing", "level", "later"),
    [
        (ExecutorCounts(), "", Level.OK, Level.OK),
        (ExecutorCounts(stalled_s=1.5), "", Level.WARN, Level.WARN),
        (ExecutorCounts(stalled_s=STALL_S + 1), "", Level.ERROR, Level.ERROR),
        (ExecutorCounts(failed_callbacks=3), "", Level.WARN, Level.OK),
        (ExecutorCounts(), "rclpy cannot be imported", Level.ERROR, Level.ERROR),
    ],
)
def test_the_executor_says_when_a_callback_holds_up_all_others(seen, missing, level, later):
    clock = HeldClock()
    component = ExecutorComponent(lambda: seen, missing, clock)
    assert component.status().level is level
    assert a_while_later(component, clock).level is later


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
    said = disk_status([DiskSpace(Path("/data"), 1, free, size, writable=True)])
    assert said.level is level
    assert said.values == {"/data free_mib": free // MIB}


def test_a_folder_that_is_needed_and_cannot_be_written_is_a_warning(tmp_path):
    assert unwritable([tmp_path / "made later"]) == []
    # Root may write anywhere, but nobody makes a folder below a device.
    assert unwritable([Path("/proc/self/places")]) == [Path("/proc/self/places")]
    said = DiskComponent(list, lambda: [Path("/proc/self/places")]).status()
    assert (said.level, said.message) == (Level.WARN, "/proc/self/places: not writable")


def test_a_disk_that_becomes_read_only_is_told_until_it_is_writable_again(tmp_path):
    with small_disk(tmp_path / "disk") as disk:
        folder = disk.path / "places"
        component = DiskComponent(lambda: [folder], lambda: [folder])
        for sealed, level in ((False, Level.OK), (True, Level.WARN), (False, Level.OK)):
            disk.seal(sealed=sealed)
            said = component.status()
            assert said.level is level
            assert (f"{folder}: not writable" in said.message) is sealed


def test_each_file_system_that_is_written_to_counts_once(tmp_path):
    (here,) = rooms([tmp_path / "not" / "made" / "yet", tmp_path])
    assert here.path == tmp_path
    assert here.size >= here.free > 0
    sealed = replace(room(tmp_path), writable=False)
    assert list(rooms([tmp_path], lambda _: sealed)) == []
    assert disk_status([]).message == "nothing is written"


def test_the_process_says_what_its_health_says():
    body = {"said": ""}
    health = Health(Components())
    health.add(HealthCheck("conversation", lambda: ""))
    health.add(HealthCheck("body", lambda: body["said"]))
    process = ProcessComponent(health, "1", lambda: {"too_long": 3, "too_many": 0})
    assert (process.status().level, process.status().message) == (Level.WARN, "start: starting")
    health.started()
    said = process.status()
    assert said.level is Level.OK
    assert said.values["memory_mib"] > 5
    assert (said.values["refused_too_long"], said.values["refused_too_many"]) == (3, 0)
    body["said"] = "has not moved for 7.0 s"
    assert process.status().level is Level.ERROR


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
