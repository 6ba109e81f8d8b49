"""How fast a running agent answers and stops, and its memory, seen over ROS 2.

`edgevox-agent` runs in a process of its own, as users start it.
"""

from benchmarks.core.figures import Figure, Measured
from benchmarks.core.stopwatch import resident_mb
from benchmarks.core.talker import PLAIN, QUESTIONS, READ, Talker, start_aloud_s
from edgevox.apps.agent.models import SMALLER

TABLE = "Answering and stopping"
ROUNDS = 5
STATE_HZ = "--ros2-state-hz=100"
"""So often does the robot say how fast it is: when it stood still is known to 10 ms."""


def measure(quick: bool = False) -> Measured:
    """An agent without a model, then one with the small one."""
    rounds = 1 if quick else ROUNDS
    aloud_s = start_aloud_s()
    with Talker("--llm=none", STATE_HZ) as bare:
        bare_mb = resident_mb(bare.pid)
    with Talker(f"--llm={SMALLER}", STATE_HZ) as talker:
        return Measured(
            figures=(
                _one("start", "start to ready", [talker.start_s], "s"),
                Figure.of(
                    "start_aloud", TABLE, "start to ready, with a voice", [aloud_s], "s", wanted=5.0
                ),
                _one(
                    "first_answer",
                    "first question to the model, right after the start, to its first sentence",
                    [1000 * talker.acknowledged_s(QUESTIONS[0])],
                    "ms",
                ),
                _one(
                    "plain_command",
                    "plain command to acknowledgement",
                    [1000 * talker.acknowledged_s(text) for text in PLAIN * rounds],
                    "ms",
                ),
                _one(
                    "read_command",
                    "command that no template knows to acknowledgement",
                    [1000 * talker.acknowledged_s(text) for text in READ * rounds],
                    "ms",
                ),
                _one(
                    "answer",
                    "question to the first sentence of the model's answer",
                    [1000 * talker.acknowledged_s(text) for text in QUESTIONS * rounds],
                    "ms",
                ),
                _one(
                    "first_token",
                    "long answer of the model: to its first token",
                    [1000 * talker.first_token_s() for _ in range(rounds)],
                    "ms",
                ),
                _one(
                    "stop",
                    '"stop" to zero velocity while the model generates',
                    [1000 * talker.stopped_s() for _ in range(2 * rounds)],
                    "ms",
                ),
                _one("memory_bare", "memory without a model", [bare_mb], "MB"),
                _one(
                    "memory_small", "memory with the small model", [resident_mb(talker.pid)], "MB"
                ),
            )
        )


def _one(identifier: str, what: str, samples: list[float], unit: str) -> Figure:
    return Figure.of(identifier, TABLE, what, samples, unit)
