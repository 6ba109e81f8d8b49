"""A signal in every state ends the program in time, whole and without a word too much.

It is told in which state it is by its own log, and hears a recording while it is typed to.
"""

import os
import signal
import subprocess
import sys
import threading
import wave
from pathlib import Path

import pytest
from guards import HUNG_S
from listener_rig import loud, says_espeak, silence
from support.recordings import write_wav
from test_voice_program import AGENT
from waiting import Heard

from edgevox.apps.run_program import STUCK

pytestmark = pytest.mark.long

DEAF_TO_NOTHING = ("env", "--default-signal=INT")
"""What a script starts in the background ignores Ctrl-C, and so do its children."""
BEFORE_A_HANDLER = -signal.SIGTERM
"""As a shell's 143: it was stopped before it had anything to put away."""
TINY, ESPEAK = "smollm2-135m-instruct", "espeak-en"
STORY = "tell me a very long story about a dragon and a princess"


class Program:
    """The agent with speech in and out, its lines as they come, and a hand that types."""

    def __init__(self, folder: Path, *, llm: str, voice: str) -> None:
        said, self.answers = folder / "said.wav", folder / "answers.wav"
        speech = loud(says_espeak("where are you", "en-us"), 0.08)
        write_wav(said, silence(0.5), speech, silence(60.0))
        self._process = subprocess.Popen(
            [
                *DEAF_TO_NOTHING,
                *(AGENT, "robot-apartment", "--no-render", "--llm", llm, "--voice", voice),
                *("--audio-in", str(said), "--audio-out", str(self.answers)),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=os.environ | {"EDGEVOX_LOG_LEVEL": "debug", "EDGEVOX_LOG_FORMAT": "json"},
        )
        self._printed = Heard[str]()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    @property
    def lines(self) -> list[str]:
        return self._printed.messages

    @property
    def output(self) -> str:
        return "\n".join(self.lines)

    def type(self, text: str) -> None:
        self._process.stdin.write(f"{text}\n")
        self._process.stdin.flush()

    def wait_for(self, wanted: str) -> None:
        """A line that holds this; fails loudly if the program ends before."""
        self._printed.wait_for(lambda line: wanted in line)

    def end(self, number: signal.Signals) -> int:
        """Send the signal; the exit code."""
        self._process.send_signal(number)
        code = self._process.wait(HUNG_S)
        self._reader.join()
        return code

    def close(self) -> None:
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._process.stdin.close()
        self._reader.join()
        self._process.stdout.close()

    def _read(self) -> None:
        for line in self._process.stdout:
            self._printed.add(line.rstrip("\n"))
        self._printed.over()


def state(name: str) -> str:
    return f'"state":"{name}"'


# An engine that is amid a piece of work on a busy machine is left behind, which is said.
CASES = {
    # what is typed, what shows the state, the model, the voice, the exit codes
    "loading models": ("", "loading ", TINY, ESPEAK, {0, BEFORE_A_HANDLER}),
    "warming up": ("", "warming up", TINY, ESPEAK, {0}),
    "transcribing": ("", state("transcribing"), "none", ESPEAK, {0}),
    "thinking": (STORY, state("thinking"), TINY, ESPEAK, {0}),
    "speaking": ("what can you do", state("speaking"), "none", "en_US-joe-medium", {0}),
    "driving": ("go to the bedroom", '"goal_started"', "none", ESPEAK, {0}),
}


@pytest.fixture
def program(tmp_path):
    started: list[Program] = []

    def start(**what: str) -> Program:
        started.append(Program(tmp_path, **what))
        return started[-1]

    yield start
    for one in started:
        one.close()


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("driving", signal.SIGTERM),  # it listens meanwhile
        pytest.param("loading models", signal.SIGTERM, marks=pytest.mark.long),
        pytest.param("warming up", signal.SIGINT, marks=pytest.mark.long),
        pytest.param("transcribing", signal.SIGTERM, marks=pytest.mark.long),
        pytest.param("thinking", signal.SIGTERM, marks=pytest.mark.long),
        pytest.param("speaking", signal.SIGINT, marks=pytest.mark.long),
    ],
)
def test_it_leaves_by_itself_from_every_state(program, name, number):
    typed, shown, llm, voice, codes = CASES[name]
    one = program(llm=llm, voice=voice)
    if typed:
        one.type(typed)
    one.wait_for(shown)

    code = one.end(number)

    assert code in codes, one.output
    assert "Traceback" not in one.output
    assert "leaving_late" not in one.output
    if one.answers.exists():
        with wave.open(str(one.answers)) as file:
            assert file.getnframes() * file.getsampwidth() <= one.answers.stat().st_size


def test_what_will_not_let_go_is_left_behind_in_time_and_named():
    program = (
        "import sys, threading\n"
        "from edgevox.apps.agent.main import main\n"
        "threading.Thread(target=threading.Event().wait, name='stuck').start()\n"
        "sys.exit(main())"
    )
    process = subprocess.Popen(
        [
            sys.executable,
            "-c",
            program,
            "robot-apartment",
            "--text-mode",
            "--llm=none",
            "--leave-s=10",
        ],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while "is ready" not in process.stdout.readline():
        assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=HUNG_S)

    assert process.returncode == STUCK
    assert "leaving without what does not end: MainThread, stuck" in errors
