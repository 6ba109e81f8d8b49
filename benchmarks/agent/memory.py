"""The memory of an agent with the whole default set.

`edgevox-agent robot-apartment --ros2`, with a recording as microphone and a file as loudspeaker,
hears a plain command, a command that no template knows, and a question for the model, and speaks
all answers. Sampled ten times a second, with all child processes. PSS counts a share of the memory
that processes share.
"""

import os
import subprocess
import tempfile
from pathlib import Path

from listener_rig import loud, says_piper, silence
from support.recordings import write_wav

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.stopwatch import repeatedly
from benchmarks.core.talker import AGENT, isolate
from edgevox.apps.agent.models import SMALLER
from edgevox.models import ModelMissing

TABLE = "Memory with the default set"
SAID = ("go to the kitchen", "get yourself to the bedroom, please", "how do bees make honey?")
WANTED_MB = 2000.0
LOOK_EVERY_S = 0.1
LONGEST_S = 600.0
BETWEEN_S = 3.0


class Memory:
    """The most that a process and its children had at once, in MB, while it was looked at."""

    def __init__(self, process: int) -> None:
        self._process = process
        self.resident = self.shared_out = 0.0

    def look(self) -> None:
        """Note what they have now."""
        resident = shared_out = 0.0
        for one in _family(self._process):
            try:
                rollup = Path(f"/proc/{one}/smaps_rollup").read_text(encoding="ascii")
            except (FileNotFoundError, ProcessLookupError):
                continue  # it has ended meanwhile
            sizes = dict(line.split(":", 1) for line in rollup.splitlines()[1:])
            resident += _mb(sizes["Rss"])
            shared_out += _mb(sizes["Pss"])
        self.resident = max(self.resident, resident)
        self.shared_out = max(self.shared_out, shared_out)


def measure(quick: bool = False) -> Measured:
    """One run, from the start until it has said its last answer."""
    del quick  # there is only one run
    isolate()
    with tempfile.TemporaryDirectory() as folder:
        said, answers = Path(folder, "said.wav"), Path(folder, "answers.wav")
        try:
            _record(said)
        except ModelMissing as error:
            raise NotHere(str(error)) from error
        memory, printed = _run(said, answers)
    exchanged = _exchanged(printed)
    return Measured(
        figures=(
            _one("resident", "hearing, thinking and speaking: resident", memory.resident),
            _one("shared_out", "of it what no other process shares, and its part of the rest (PSS)",
                 memory.shared_out),
        ),
        notes={"What was heard, and answered": exchanged},
    )  # fmt: skip


def _record(file: Path) -> None:
    pieces = [silence(1.0)]
    for text in SAID:
        pieces += [loud(says_piper(text), 0.08), silence(BETWEEN_S)]
    write_wav(file, *pieces)


def _run(said: Path, answers: Path) -> tuple[Memory, list[str]]:
    """Its memory, and the lines that it printed; it leaves at the end of the recording."""
    sound = ("--audio-in", str(said), "--audio-out", str(answers))
    with subprocess.Popen(
        [AGENT, "robot-apartment", "--ros2", f"--llm={SMALLER}", *sound],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        memory = Memory(process.pid)
        with repeatedly(memory.look, LOOK_EVERY_S, "memory"):
            try:
                printed, _ = process.communicate(timeout=LONGEST_S)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
    if process.returncode:
        raise RuntimeError(f"the agent ended with {process.returncode}: {printed}")
    return memory, printed.splitlines()


def _exchanged(printed: list[str]) -> tuple[str, ...]:
    """What was heard and answered; all of it, else some part was not in the memory."""
    heard = [line for line in printed if line.startswith("> ")]
    answered = [line for line in printed if line.startswith("  ")]
    if len(heard) != len(SAID) or len(answered) < len(SAID):
        raise RuntimeError("\n".join(["it did not hear and answer everything:", *printed]))
    return tuple(line.removeprefix("> ").strip() for line in printed if line in {*heard, *answered})


def _family(process: int) -> list[int]:
    """A process and all that come from it."""
    tasks = Path(f"/proc/{process}/task")
    try:
        names = [Path(tasks, task, "children") for task in os.listdir(tasks)]
        children = [int(one) for name in names for one in name.read_text(encoding="ascii").split()]
    except (FileNotFoundError, ProcessLookupError):
        children = []
    return [process, *(one for child in children for one in _family(child))]


def _mb(size: str) -> float:
    """Of a size as the kernel writes it, such as `12 kB`."""
    return int(size.split(maxsplit=1)[0]) * 1024 / 1e6


def _one(identifier: str, what: str, value: float) -> Figure:
    return Figure.of(identifier, TABLE, what, [value], "MB", wanted=WANTED_MB)
