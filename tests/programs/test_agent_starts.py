"""How `edgevox-agent` starts: with what it needs, and what it says where that is not here."""

import os
import subprocess
import sys
from pathlib import Path

import phrases
import pytest
from gguf_files import small_gguf
from guards import HUNG_S, run_program

AGENT = Path(sys.executable).with_name("edgevox-agent")
NOT_FOR_TYPING = {
    "av", "ctranslate2", "faster_whisper", "onnxruntime", "prompt_toolkit", "pynvml", "rclpy",
    "textual",
}  # fmt: skip


def test_what_is_typed_to_loads_no_engine_of_sound_no_screen_and_no_other_robot(tmp_path):
    about = tmp_path / "someone-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: someone\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[edgevox.robots]\nrobot-slow = slow_to_load:ROBOT\n")
    (tmp_path / "slow_to_load.py").write_text("print('loaded')")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    program = (
        "import sys; from edgevox.apps.agent.main import main; "
        "print('ended with', main(sys.argv[1:]))\n"
        "print(*sys.modules, file=sys.stderr)"
    )
    done = run_program(
        [sys.executable, "-c", program, "robot-apartment", "--text-mode", "--llm=none"],
        env=os.environ | {"PYTHONPATH": path},
        input="where are you\n",
    )

    assert phrases.stands(room="living_room") in done.stdout
    assert "ended with 0" in done.stdout
    assert "loaded" not in done.stdout
    (modules,) = done.stderr.splitlines()
    assert not NOT_FOR_TYPING.intersection(modules.split())


def test_a_robot_whose_model_is_missing_ends_the_program_with_1(tmp_path, monkeypatch):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    done = run_program([AGENT, "robot-panda", "--text-mode", "--llm=none"])
    assert done.returncode == 1
    assert "edgevox-models fetch" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.long
def test_without_its_wake_words_it_does_not_start_and_names_the_command(tmp_path):
    flags = ["--llm=none", "--audio-in=none", "--wakeword=hey jarvis"]
    done = run_program(
        [AGENT, "robot-apartment", *flags, f"--audio-out={tmp_path / 'answers.wav'}"],
        env=os.environ | {"EDGEVOX_MODELS_DIR": str(tmp_path / "models")},
    )

    assert done.returncode == 1
    assert "get it with: edgevox-models fetch micro-wake-words" in done.stderr


@pytest.mark.long
@pytest.mark.parametrize("flag", ["world", "scenario", "config"])
def test_the_program_refuses_a_pipe_in_one_line(flag, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    done = subprocess.run(
        [AGENT, "robot-apartment", "--text-mode", f"--{flag}=pipe"],
        cwd=tmp_path,  # a long name would be cut
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=HUNG_S,
    )
    expected = "a file that can be read (Not a regular file)"
    told = f"edgevox-agent: {flag}: got 'pipe', expected {expected}"
    assert (done.returncode, done.stderr.decode().strip()) == (2, told)


def test_a_process_that_may_not_have_the_memory_goes_on_without_the_model(tmp_path):
    """Really so: the kernel gives this process no more address space."""
    program = (
        "import resource, sys\n"
        "from edgevox.apps.agent.main import main\n"
        "taken = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (taken + (180 << 20),) * 2)\n"
        "sys.exit(main())"
    )
    done = run_program(
        [
            sys.executable,
            "-c",
            program,
            "robot-apartment",
            "--text-mode",
            f"--llm={small_gguf(tmp_path)}",
        ],
        input="where are you\n",
    )

    assert done.returncode == 0, done.stderr
    assert "out of memory: a context of 4096 tokens needs about 0.2 GB" in done.stderr
    assert phrases.stands(room="living_room") in done.stdout
