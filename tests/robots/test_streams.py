"""Standard input, output and error as the world gives them: full, gone, asleep, closed, ASCII."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from guards import HUNG_S

pytestmark = pytest.mark.long

PROGRAMS = Path(sys.executable).parent
AGENT = [str(PROGRAMS / "edgevox-agent"), "robot-apartment", "--text-mode", "--llm=none"]
LOGGED = ["--log-level=info", "--log-format=json"]
DRIVE = b"go to x 4.3 and y 2\n"
ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
"""A locale that knows no language but English, with Python's own remedies for it switched off."""


def events(log: bytes) -> list[str]:
    return [json.loads(line)["event"] for line in log.splitlines()]


@pytest.mark.parametrize(
    "flags", [(), pytest.param(("--log-format=console",), marks=pytest.mark.long)]
)
def test_a_full_disk_under_its_output_ends_no_drive_and_is_said_once(flags):
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [*AGENT, *LOGGED, *flags],
            input=DRIVE,
            stdout=full,
            stderr=subprocess.PIPE,
            timeout=HUNG_S,
        )
    assert done.returncode == 0
    assert done.stderr.count(b"output_lost") == 1
    assert b"No space left on device" in done.stderr
    assert b"goal_succeeded" in done.stderr
    assert b"Traceback" not in done.stderr


def test_a_reader_who_leaves_ends_no_drive_and_is_said_once():
    agent = subprocess.Popen(
        [*AGENT, *LOGGED], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert b"is ready" in agent.stdout.readline()
    agent.stdout.close()
    _, log = agent.communicate(DRIVE, timeout=HUNG_S)
    assert agent.returncode == 0
    assert events(log).count("output_lost") == 1
    assert "goal_succeeded" in events(log)


def test_a_reader_who_sleeps_holds_up_nothing():
    agent = subprocess.Popen(
        [*AGENT, *LOGGED], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    agent.stdin.write(b"/map\n" * 200 + DRIVE)  # more than fits into a pipe
    agent.stdin.close()
    log = agent.stderr.read()  # until it has ended; what it wrote to stdout nobody has read yet
    assert agent.wait(HUNG_S) == 0
    assert events(log).count("output_lost") == 1
    assert "goal_succeeded" in events(log)
    agent.stdout.close()


@pytest.mark.parametrize(
    "closed", ["1 2", *(pytest.param(one, marks=pytest.mark.long) for one in "12")]
)
def test_without_streams_it_does_what_it_is_told(tmp_path, closed):
    picture = tmp_path / "robot.png"
    closing = " ".join(f"{number}>&-" for number in closed.split())
    command = ["sh", "-c", f'exec "$@" {closing}', "sh", *AGENT]
    done = subprocess.run(command, input=DRIVE + f"/picture {picture}\n".encode(), timeout=HUNG_S)
    assert done.returncode == 0
    assert picture.is_file()


def test_an_unwritable_log_does_not_keep_a_wrong_setting_from_its_exit_code():
    with open("/dev/full", "wb") as full:
        done = subprocess.run([*AGENT, "--seed=-1"], stdout=full, stderr=full, timeout=HUNG_S)
    assert done.returncode == 2


def test_nor_one_of_the_container():
    command = [sys.executable, "-m", "edgevox.apps.container.start"]
    wrong = {**os.environ, "EDGEVOX_AGENT": "robot-teapot"}
    with open("/dev/full", "wb") as full:
        done = subprocess.run(command, env=wrong, stdout=full, stderr=full, timeout=HUNG_S)
    assert done.returncode == 64


@pytest.mark.parametrize(
    "command", [["edgevox-models", "list"], ["edgevox-models", "licences"], ["edgevox-agent", "-h"]]
)
def test_a_reader_who_has_seen_enough_ends_a_tool_quietly(command):
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [PROGRAMS / command[0], *command[1:]],
        stdout=writing,
        stderr=subprocess.PIPE,
        timeout=HUNG_S,
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_tool_whose_answer_is_lost_has_failed_and_says_so_in_one_line():
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [PROGRAMS / "edgevox-models", "list"],
            stdout=full,
            stderr=subprocess.PIPE,
            timeout=HUNG_S,
        )
    assert done.returncode == 1
    assert done.stderr == b"edgevox-models: standard output: No space left on device\n"


@pytest.mark.parametrize(
    ("language", "said", "answer"),
    [
        ("vi", "đi vào bếp", "Tôi đang ở"),
        pytest.param("fr", "va à la cuisine", "Je suis dans la cuisine.", marks=pytest.mark.long),
    ],
)
def test_where_the_locale_knows_ascii_only_every_language_is_spoken(language, said, answer):
    done = subprocess.run(
        [*AGENT, f"--language={language}"],
        input=f"{said}\n".encode(),
        env={**os.environ, **ASCII},
        capture_output=True,
        timeout=HUNG_S,
    )
    shown = done.stdout.decode()
    assert (done.returncode, done.stderr) == (0, b"")
    assert f"> {said}" in shown
    assert answer in shown
