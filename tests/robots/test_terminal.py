"""The program as a person meets it: at a prompt, through a pipe, and with nobody there."""

import io
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pexpect
import phrases
import pytest
from agent_here import Done, run_agent
from guards import HUNG_S

ARGUMENTS = ["robot-apartment", "--text-mode", "--llm=none"]
COMMAND = [str(Path(sys.executable).with_name("edgevox-agent")), *ARGUMENTS]


def run_script(text: str | bytes, *flags: str) -> Done:
    return run_agent(*ARGUMENTS, *flags, said=text)


@pytest.mark.long
def test_a_script_is_done_line_by_line_and_ends_the_program():
    said = b"go to the kitchen\nwhere are you\n"
    done = subprocess.run(COMMAND, input=said, capture_output=True, timeout=HUNG_S)
    lines = [line.strip() for line in done.stdout.decode().splitlines()]
    assert done.returncode == 0
    assert lines[1:5] == [
        "> go to the kitchen",
        phrases.begins("navigate_to", room="kitchen"),
        phrases.done("navigate_to", room="kitchen"),
        "> where are you",
    ]
    assert lines[5].startswith(phrases.stands(room="kitchen") + "6.")
    assert done.stderr == b""


def test_bytes_that_are_no_text_and_very_long_lines_are_answered():
    done = run_script(b"\xff\xfe\n" + b"a" * 100_000 + b"\nwhere are you\n")
    answer = done.stdout
    assert done.returncode == 0
    assert phrases.said("not_heard") in answer
    assert phrases.said("too_long", length=100000, limit=2000) in answer
    assert phrases.stands(room="living_room") in answer


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("/map", "kitchen"),
        ("/help", "/reset"),
        ("/state", '"battery": '),
        ("/skills", "navigate_to(room)"),
        ("/stop it", "/stop: got 'it', expected nothing after it"),
        ("/picture /nowhere/at/all.png", "snapshot: got '/nowhere/at/all.png', expected a file in"),
        ("/dance", "/dance: unknown command; expected one of /help, /map"),
    ],
)
def test_a_slash_command_is_answered(line, answer):
    assert answer in run_script(f"{line}\n").stdout


def test_a_picture_is_written_where_the_person_says(tmp_path):
    file = tmp_path / "my robot.png"
    assert f"Picture saved: {file}" in run_script(f"/picture {file}\n").stdout
    assert file.read_bytes().startswith(b"\x89PNG")


def test_restart_puts_the_world_back_and_the_robot_stands_at_the_start():
    done = run_script("where are you\ngo to x 4.3 and y 2\n/restart\nwhere are you\n")
    answers = [line.strip() for line in done.stdout.splitlines() if " at x " in line]
    assert len(answers) == 3
    assert answers[0] == answers[-1] != answers[1]


def test_where_there_is_a_display_the_robot_is_shown(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":no.such.display")
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    agent = subprocess.Popen(COMMAND, **pipes)
    assert b"is ready" in agent.stdout.readline()
    assert b"no_window" in agent.stderr.readline()
    _, errors = agent.communicate(b"/quit\n", timeout=HUNG_S)
    assert agent.returncode == 0
    assert b"window" not in errors


def test_quit_ends_a_script_early():
    done = run_script("/quit\nwhere are you\n")
    assert done.returncode == 0
    assert "I am in" not in done.stdout


@pytest.mark.parametrize("stop", ["stop", "/stop", "/reset"])
def test_in_a_script_nothing_before_a_stop_moves_the_robot_and_what_is_after_it_is_done(stop):
    done = run_script(f"go to the kitchen\ngo to the bedroom\n{stop}\nwhere are you\n")
    lines = [line.strip() for line in done.stdout.splitlines()]
    assert done.returncode == 0
    assert f"> {stop}" in lines
    assert "[cancelled lines before this stop: 2]" in lines
    going = {phrases.begins("navigate_to", room=room) for room in ("kitchen", "bedroom")}
    assert not going & set(lines)
    assert any(line.startswith(phrases.stands(room="living_room")) for line in lines)


def test_a_script_that_ends_with_a_stop_is_answered():
    assert phrases.said("standing") in run_script("stop\n").stdout


@pytest.mark.parametrize(
    "stdin",
    ["null", *(pytest.param(one, marks=pytest.mark.long) for one in ("closed", "empty pipe"))],
)
def test_with_nobody_there_it_runs_until_sigterm(stdin):
    source = subprocess.DEVNULL if stdin == "null" else subprocess.PIPE
    agent = subprocess.Popen(
        [*COMMAND] if stdin != "closed" else ["sh", "-c", 'exec "$@" <&-', "sh", *COMMAND],
        stdin=source,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    if agent.stdin:
        agent.stdin.close()
    ready = agent.stdout.readline()
    assert b"is ready" in ready
    with pytest.raises(subprocess.TimeoutExpired):
        agent.wait(1)
    agent.send_signal(signal.SIGTERM)
    assert agent.wait(HUNG_S) == 0
    assert agent.stdout.read() == b""
    agent.stdout.close()


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (["--world", "nowhere.yaml"], "nowhere.yaml"),
        (["--language=xx"], "language: got 'xx', expected one of en"),
        (["--voice=nobody"], "voice: got 'nobody', expected for the language en"),
        (["--no-text-mode", "--audio-in=ros2"], "audio_in: got 'ros2', expected ros2 only"),
        (["--no-text-mode", "--audio-out=/no/x.wav"], "audio_out: got '/no/x.wav', expected"),
        (["--no-text-mode", "--audio-in=no.wav"], "audio_in: got 'no.wav', expected a WAV file"),
        (["--no-text-mode", "--wakeword=hey you"], "wakeword: got 'hey you', expected one of"),
        (["--config", "nowhere.toml"], "config: got 'nowhere.toml', expected a file"),
    ],
)
def test_a_wrong_setting_ends_it_with_the_fields_name_and_exit_code_2(flags, message):
    refused = run_script("", *flags)
    assert refused.returncode == 2
    assert message in refused.stderr
    assert "Traceback" not in refused.stderr


def test_a_typo_in_a_world_file_ends_it_with_the_fields_name(tmp_path):
    world = tmp_path / "world.yaml"
    world.write_text("world: {heigth: 10, width: 10}\nrobot: {kinematics: {name: diff}}\n")
    refused = run_script("", "--world", str(world))
    assert refused.returncode == 2
    assert "heigth" in refused.stderr
    assert "height" in refused.stderr


def test_without_its_model_it_names_the_command_that_fetches_it_and_obeys(tmp_path, monkeypatch):
    monkeypatch.setenv("EDGEVOX_MODELS_DIR", str(tmp_path))
    done = run_agent("robot-apartment", "--text-mode", said="where are you\n")
    assert done.returncode == 0
    assert "edgevox-models fetch" in done.stderr
    assert phrases.stands(room="living_room") in done.stdout


def see(terminal, text, timeout_s=HUNG_S):
    """Wait until the text is on the screen, answering where the cursor is as a terminal does."""
    while terminal.expect_exact(["\x1b[6n", text], timeout=timeout_s) == 0:
        terminal.send("\x1b[10;1R")


@contextmanager
def at_terminal(*flags, term="xterm"):
    """The program at a terminal of its own; however long it takes to end, it is waited for."""
    terminal = pexpect.spawn(
        COMMAND[0],
        [*COMMAND[1:], *flags],
        dimensions=(24, 80),
        encoding="utf-8",
        env={**os.environ, "TERM": term},
    )
    try:
        yield terminal
    finally:
        if terminal.isalive():
            terminal.kill(signal.SIGKILL)
            terminal.wait()
        terminal.close()


@pytest.fixture
def prompt():
    with at_terminal("--simple-ui") as terminal:
        see(terminal, "is ready")
        see(terminal, ">")
        yield terminal


@pytest.mark.parametrize("screen", [["--simple-ui"], []], ids=["prompt", "full screen"])
def test_a_stop_that_is_typed_before_the_prompt_keeps_what_is_before_it_from_moving(screen):
    with at_terminal(*screen, term="xterm-256color") as terminal:
        terminal.logfile_read = shown = io.StringIO()
        terminal.send("go to the kitchen\rstop\rwhere are you\r")
        see(terminal, "standing still", timeout_s=HUNG_S)
        see(terminal, "living room")
        assert "Going to the" not in shown.getvalue()


def test_the_prompt_shows_progress_a_stop_acts_at_once_and_ctrl_c_only_stops(prompt):
    prompt.send("go to the kitchen\r")
    see(prompt, phrases.begins("navigate_to", room="kitchen"))
    see(prompt, "navigate_to room=kitchen")
    see(prompt, "█")
    see(prompt, phrases.done("navigate_to", room="kitchen"))
    prompt.send("go to the bedroom\r")
    see(prompt, phrases.begins("navigate_to", room="bedroom"))
    prompt.send("stop\r")
    see(prompt, phrases.said("stopped"))
    prompt.send("go to the office\r")
    see(prompt, phrases.begins("navigate_to", room="office"))
    prompt.send("\x03")
    see(prompt, "stopped; Ctrl-D exits")
    prompt.send("\x03")
    see(prompt, "stopped; Ctrl-D exits")
    prompt.send("/quit\r")
    prompt.expect(pexpect.EOF, timeout=HUNG_S)
    prompt.wait()
    assert prompt.exitstatus == 0


@pytest.mark.long
def test_ctrl_d_leaves(prompt):
    prompt.send("\x04")
    prompt.expect(pexpect.EOF, timeout=HUNG_S)
    prompt.wait()
    assert prompt.exitstatus == 0


def test_sigterm_at_the_prompt_leaves_the_terminal_as_it_was(prompt):
    prompt.kill(signal.SIGTERM)
    prompt.expect(pexpect.EOF, timeout=HUNG_S)
    prompt.wait()
    assert prompt.exitstatus == 0
    assert "Traceback" not in prompt.before


@pytest.fixture
def full_screen():
    with at_terminal(term="xterm-256color") as terminal:
        see(terminal, "listening")
        yield terminal


def test_the_full_screen_shows_answers_and_leaves_the_terminal_as_it_was(full_screen):
    full_screen.send("where are you\r")
    see(full_screen, "living room")
    full_screen.send("\x11")  # Ctrl-Q
    see(full_screen, "\x1b[?1049l")  # the alternate screen is left
    full_screen.expect(pexpect.EOF, timeout=HUNG_S)
    full_screen.wait()
    assert full_screen.exitstatus == 0


@pytest.mark.long
def test_sigterm_ends_the_full_screen_in_order(full_screen):
    full_screen.kill(signal.SIGTERM)
    see(full_screen, "\x1b[?1049l")
    full_screen.expect(pexpect.EOF, timeout=HUNG_S)
    full_screen.wait()
    assert full_screen.exitstatus == 0
