"""The doctor's judgement of a machine, from plain values."""

from dataclasses import dataclass

import pytest
from doctor_rig import ERROR, OK, SKIPPED, WARNING, levels, situation
from gguf_files import small_gguf

from edgevox.agent.llm import weights
from edgevox.agent.llm.factory import load_model
from edgevox.agent.llm.language_model import ModelFailed
from edgevox.apps.agent.models import chosen_llm
from edgevox.apps.doctor import machine, sound
from edgevox.apps.doctor import machine as graphics
from edgevox.core.status import Components, Finding, Level, Off, Status
from edgevox.models import Store
from edgevox.ops.health import Health, HealthServer
from edgevox.ops.machine import MIB

PC = {
    "edgevox": "1.2.3",
    "version": [3, 12, 1],
    "system": "Linux",
    "release": "6.1",
    "machine": "x86_64",
}


@pytest.mark.parametrize(
    ("changed", "level"),
    [({}, OK), ({"version": [3, 10, 2]}, ERROR), ({"system": "Darwin"}, WARNING)],
)
def test_python_must_be_one_that_the_packages_are_built_for(changed, level):
    assert machine.judge_python(PC | changed, situation()).level is level


CPU = {"cores": 8, "usable": 8, "quota": None, "missing": []}


@pytest.mark.parametrize(
    ("changed", "settings", "level"),
    [
        ({}, {}, OK),
        ({"missing": ["avx2"]}, {}, ERROR),
        ({"missing": ["avx2"]}, {"llm": "none"}, WARNING),
        ({"missing": ["avx2"]}, {"llm_backend": "llama-cpp-python"}, WARNING),
        ({"usable": 1, "quota": 1.0}, {}, WARNING),
        ({"usable": 2, "quota": 2.5}, {}, OK),
    ],
)
def test_a_processor_must_have_what_the_language_model_is_built_for(changed, settings, level):
    assert machine.judge_processor(CPU | changed, situation(**settings)).level is level


RAM = {"total": 8000, "free": 6000, "limited_by": "", "llm": 700}


@pytest.mark.parametrize(
    ("changed", "settings", "level"),
    [
        ({}, {}, OK),
        ({"free": 600}, {}, ERROR),
        ({"free": 600, "limited_by": "a control group's limit"}, {}, ERROR),
        ({"free": 1000}, {}, WARNING),
        ({"free": 1000}, {"text_mode": True}, OK),
        ({"free": 300, "llm": 0}, {"text_mode": True}, OK),
    ],
)
def test_memory_must_hold_the_models_below_the_limit_of_a_container(changed, settings, level):
    assert machine.judge_memory(RAM | changed, situation(**settings)).level is level


def test_what_the_language_model_takes_is_what_its_loader_asks_for(tmp_path, monkeypatch):
    path = small_gguf(tmp_path)
    here = situation(llm=str(path), llm_context=8192)
    needed = weights.needed_bytes(weights.check(path), 8192)
    assert machine.probe_memory(here)["llm"] == needed // MIB
    there = weights.Memory(8000 * MIB, (needed // MIB - 1) * MIB, "a control group's limit")
    monkeypatch.setattr(machine, "read_memory", lambda: there)
    monkeypatch.setattr(weights, "read_memory", lambda: there)
    said = machine.judge_memory(machine.probe_memory(here), here)
    assert said.level is ERROR
    assert "of 8000 MiB (a control group's limit); the language model takes" in said.found
    with pytest.raises(ModelFailed, match="out of memory: a context of 8192 tokens"):
        load_model(path, "xllamacpp", context_tokens=8192)


def test_a_model_that_is_not_here_yet_takes_at_least_its_size(tmp_path, monkeypatch):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    here = situation()
    size = Store().manifest.models[chosen_llm(here.settings)].size
    assert machine.probe_memory(here)["llm"] == (size + weights.BUFFERS_BYTES) // MIB
    assert machine.probe_memory(situation(llm="none"))["llm"] == 0


def test_a_disk_is_judged_as_on_diagnostics():
    gib = 2**30
    facts = {
        "rooms": [["/a", 1, 50 * gib, 100 * gib, True], ["/b", 2, 1000, 100 * gib, True]],
        "sealed": [],
    }
    assert levels(machine.judge_disk(facts, situation())) == [OK, ERROR]


@pytest.mark.parametrize(
    ("now_s", "synchronised", "level"),
    [(1.8e9, True, OK), (1.8e9, None, OK), (1.8e9, False, WARNING), (1000.0, True, ERROR)],
)
def test_a_clock_must_have_been_set(now_s, synchronised, level):
    facts = {"now": now_s, "synchronised": synchronised}
    assert machine.judge_clock(facts, situation()).level is level


def test_a_misspelled_variable_is_found_and_nonsense_is_an_error():
    here = situation(environment={"EDGEVOX_LANGAUGE": "en", "EDGEVOX_LLM": "none"})
    said = machine.judge_settings(machine.probe_settings(here), here)
    assert levels(said) == [WARNING, OK]
    assert "did you mean EDGEVOX_LANGUAGE" in said[0].found
    refused = situation(refused="EDGEVOX_LANGUAGE: got 'xx'")
    assert levels(machine.judge_settings({"given": [], "unknown": []}, refused)) == [ERROR]


@pytest.mark.parametrize(
    ("facts", "level"),
    [
        ({"tmp": True, "logs": True, "at": "/l"}, OK),
        ({"tmp": True, "logs": False, "at": "/l"}, WARNING),
        ({"tmp": False, "logs": True, "at": "/l"}, ERROR),
    ],
)
def test_files_must_be_writable_where_they_are_made(facts, level):
    assert machine.judge_folders(facts, situation()).level is level


@pytest.mark.parametrize(
    ("inside", "uid", "level"), [(False, 0, SKIPPED), (True, 1000, OK), (True, 0, WARNING)]
)
def test_a_container_needs_no_root(inside, uid, level):
    facts = {"inside": inside, "uid": uid, "read_only": True}
    assert machine.judge_container(facts, situation()).level is level


SEEN = {
    "root": "/models",
    "needed": ["whisper-tiny.en"],
    "wanted": ["piper-en_US-joe-medium"],
    "found": {"whisper-tiny.en": "right", "piper-en_US-joe-medium": "right"},
    "unknown": [],
    "file": "",
}


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ({}, [OK]),
        ({"whisper-tiny.en": "absent"}, [ERROR, OK]),
        ({"whisper-tiny.en": "damaged"}, [ERROR, OK]),
        ({"piper-en_US-joe-medium": "absent"}, [WARNING, OK]),
        ({"whisper-base": "damaged"}, [WARNING, OK]),
        ({"whisper-base": "absent"}, [OK]),
    ],
)
def test_models_that_are_needed_must_be_right(found, expected):
    said = machine.judge_models(SEEN | {"found": SEEN["found"] | found}, situation())
    assert levels(said) == expected
    for name, state in found.items():
        if state == "damaged":
            assert f"edgevox-models verify {name}; edgevox-models fetch" in said[0].advice


def test_what_is_needed_follows_from_the_settings():
    assert list(machine.needed(situation(text_mode=True, llm="none"))) == []
    assert list(machine.needed(situation(llm="none", wakeword="hey jarvis"))) == [
        "whisper-tiny.en",
        "micro-wake-words",
    ]
    other = situation(llm="none", wakeword="hey rhasspy", wakeword_engine="openwakeword")
    assert list(machine.needed(other)) == ["whisper-tiny.en", "wake-words"]
    assert list(machine.needed(situation(llm="none", wakeword="own.json"))) == ["whisper-tiny.en"]
    assert "franka-panda" in machine.needed(situation(agent="robot-panda"))


def test_a_truncated_and_an_altered_file_are_damaged_and_one_that_is_gone_absent(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    here = situation(llm="none", text_mode=False)
    assert machine.probe_models(here)["found"]["whisper-tiny.en"] == "absent"
    folder = tmp_path / "whisper-tiny.en"
    folder.mkdir()
    (folder / "model.bin").write_bytes(b"cut")
    facts = machine.probe_models(here)
    assert facts["found"]["whisper-tiny.en"] == "damaged"
    assert levels(machine.judge_models(facts, here))[0] is ERROR
    (folder / "model.bin").unlink()
    file = min(Store().manifest.models["whisper-tiny.en"].files, key=lambda one: one.size)
    (folder / file.name).write_bytes(b"x" * file.size)
    assert machine.probe_models(here)["found"]["whisper-tiny.en"] == "damaged"


DEVICES = {"library": "", "inputs": ["USB microphone"], "outputs": ["HDMI"]}


@pytest.mark.parametrize(
    ("changed", "settings", "expected"),
    [
        ({}, {}, [OK, OK]),
        ({}, {"audio_in": "usb"}, [OK, OK]),
        ({}, {"audio_in": "webcam"}, [ERROR, OK]),
        ({"inputs": []}, {}, [WARNING, OK]),
        ({"library": "PortAudio is not installed"}, {}, [ERROR]),
        ({"library": "PortAudio is not installed"}, {"text_mode": True}, [SKIPPED]),
        ({"inputs": []}, {"audio_in": "none", "audio_out": "./said.wav"}, [SKIPPED]),
        ({"inputs": []}, {"audio_in": "ros2"}, [OK]),
    ],
)
def test_sound_must_be_there_as_far_as_it_is_asked_for(changed, settings, expected):
    assert levels(sound.judge_sound(DEVICES | changed, situation(**settings))) == expected


@pytest.mark.parametrize(
    ("facts", "settings", "level"),
    [
        ({"failed": "", "samples": 100}, {}, OK),
        ({"failed": "not installed", "samples": 0}, {}, WARNING),
        ({"failed": "not installed", "samples": 0}, {"text_mode": True}, SKIPPED),
        ({"failed": "", "samples": 0}, {}, WARNING),
    ],
)
def test_the_last_resort_must_speak(facts, settings, level):
    assert sound.judge_espeak(facts, situation(**settings)).level is level


@pytest.mark.parametrize(
    ("settings", "found"),
    [
        ({}, "by their sound and by their words"),
        ({"language": "de"}, "by their sound and by their words"),
        ({"stop_spotter": False}, "not asked for"),
        ({"text_mode": True}, "not asked for"),
    ],
)
def test_it_says_how_stop_words_are_heard(settings, found):
    assert sound.judge_spotter(sound.probe_spotter(), situation(**settings)).found == found


@pytest.mark.parametrize(
    ("facts", "level"),
    [
        ({"names": [], "failed": ""}, OK),
        ({"names": ["L4"], "failed": ""}, OK),
        ({"names": [], "failed": "Driver/library version mismatch"}, WARNING),
    ],
)
def test_a_gpu_is_not_needed_but_a_broken_driver_is_said(facts, level):
    assert graphics.judge_gpu(facts, situation()).level is level


@pytest.mark.parametrize(
    ("failed", "installed", "level"),
    [("", True, OK), ("", False, SKIPPED), ("no libEGL", True, WARNING)],
)
def test_without_opengl_only_pictures_are_missing(failed, installed, level):
    facts = {"backend": "egl", "failed": failed, "installed": installed}
    assert graphics.judge_egl(facts, situation()).level is level


@dataclass(frozen=True)
class Part:
    """A component that says this of itself."""

    said: Status
    checks: tuple[()] = ()

    @property
    def name(self):
        return self.said.name

    def status(self):
        return self.said


def test_it_says_what_the_robot_that_runs_says_of_itself():
    sealed = Part(Status("disk", Level.WARN, "/places: not writable"))
    behind = Part(Status.judged("recorder", [Finding(Level.ERROR, "the disk is full")]))
    health = Health(Components(Off("console", "not asked for"), sealed, behind))
    server = HealthServer(health, "127.0.0.1", 0)
    server.start()
    try:
        here = situation(health_port=server.port)
        said = machine.judge_running(machine.probe_running(here), here)
    finally:
        server.close()
    assert [(one.level, one.found) for one in said] == [
        (WARNING, "disk: /places: not writable"),
        (ERROR, "recorder: the disk is full"),
    ]
    gone = machine.judge_running(machine.probe_running(here), here)
    assert gone.level is SKIPPED
    off = machine.probe_running(situation(health_port=0))
    assert machine.judge_running(off, here).level is SKIPPED
    well = {"port": 1, "components": [("process", Level.WARN, "starts"), ("disk", Level.OK, "")]}
    assert levels(machine.judge_running(well, here)) == [OK]
