"""Every metric, once. Code, docs, dashboard, alerts and tests read this.

What a metric is, before anybody counts.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from edgevox.core.agent_events import GOAL_ENDS
from edgevox.core.errors import Refusal
from edgevox.core.events import Cause, Outcome, State
from edgevox.core.ways import Way

PREFIX = "edgevox_"


class Kind(StrEnum):
    """What Prometheus calls its type."""

    COUNTER = "counter"
    GAUGE = "gauge"
    HISTOGRAM = "histogram"


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric. `help` is a sentence without its full stop.

    `labels` gives by name what its values are: all of them, or a word for a set that only a running
    agent knows, such as its skills; free text is never one. `of` says which agents have it.

    One that is `read` is looked up when somebody asks, the others are counted as things happen. By
    the values of its label (an empty one, if it has no label) `read` says which value of which
    component's status that is, as ``sim.stalled_s``; True is for what no status can say.
    """

    name: str
    kind: Kind
    help: str
    labels: Mapping[str, tuple[str, ...] | str] = field(default_factory=dict)
    buckets: tuple[float, ...] = ()
    of: str = "every agent"
    read: bool | Mapping[str, str] = False

    @property
    def series(self) -> frozenset[str]:
        """The names under which samples of it appear."""
        if self.kind is Kind.HISTOGRAM:
            return frozenset(f"{self.name}_{part}" for part in ("bucket", "count", "sum"))
        return frozenset({self.name})


SKILLS, CHECKS, TOPICS = "the agent's skills", "the checks of health", "topics that come in"
STAGES = ("stt", "llm", "tts", "ttfs", "total")
SOURCES = ("template", "model", "command", "action", "program")
QUEUES = ("conversation", "microphone", "transcriber", "speech_output", "recorder")
PARTS = (
    "listener",
    "transcriber",
    "speech_output",
    "body",
    "executor",
    "ticker",
    "camera",
    "metrics",
)
BAD_REQUESTS = ("http", "tls", "connection", "cookie", "origin", "code", "message", "crowd")
MODELS = ("stt", "llm", "tts")

SIMULATED, MOVES = "a simulated body", "an agent with a body"
ALOUD, ON_ROS2 = "an agent with a voice", "an agent on ROS 2"
STEERED, SHARED = "a body that takes velocities", "an agent with `llm_endpoint`"

SHORT_S = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 60.0)
LONG_S = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0)

_COUNTED = (
    Metric(
        "edgevox_turns_total",
        Kind.COUNTER,
        "Turns that somebody asked for in words, by what became of them",
        {"outcome": tuple(Outcome)},
    ),
    Metric(
        "edgevox_turn_stage_seconds",
        Kind.HISTOGRAM,
        "What the stages of a turn took; ttfs is the time to the first sign of an answer, total"
        " to its end; a stage that a turn did not need is not counted",
        {"stage": STAGES},
        SHORT_S,
    ),
    Metric(
        "edgevox_llm_tokens_total",
        Kind.COUNTER,
        "Tokens that language models generated for turns, calls of skills among them; about that"
        " many where a server answers",
    ),
    Metric(
        "edgevox_skill_calls_total",
        Kind.COUNTER,
        "Calls of skills, by who found out that one was meant",
        {"source": SOURCES},
    ),
    Metric(
        "edgevox_skill_goals_total",
        Kind.COUNTER,
        "Goals of skills that ended, by how",
        {"skill": SKILLS, "outcome": GOAL_ENDS},
    ),
    Metric(
        "edgevox_skill_goals_running",
        Kind.GAUGE,
        "Goals of skills that run now",
        {"skill": SKILLS},
    ),
    Metric(
        "edgevox_skill_goal_seconds",
        Kind.HISTOGRAM,
        "How long goals ran, whatever their end",
        {"skill": SKILLS},
        LONG_S,
    ),
    Metric(
        "edgevox_interrupts_total",
        Kind.COUNTER,
        "Demands for silence or a halt, by who made them",
        {"cause": tuple(Cause)},
    ),
    Metric(
        "edgevox_safety_stops_total",
        Kind.COUNTER,
        "Stop words that were heard or read and found something to stop",
    ),
    Metric("edgevox_wake_words_total", Kind.COUNTER, "Wake words that were heard", of=ALOUD),
    Metric(
        "edgevox_state",
        Kind.GAUGE,
        "What the conversation does now: 1 for that state, 0 for the others",
        {"state": tuple(State)},
    ),
)

_READ = (
    Metric(
        "edgevox_build_info",
        Kind.GAUGE,
        "1; its labels say what runs and which language it hears and speaks",
        {"version": "a version", "agent": "a robot's name, or a program's", "language": "a code"},
        read=True,
    ),
    Metric("edgevox_ready", Kind.GAUGE, "Whether it can be used, as /ready says", read=True),
    Metric(
        "edgevox_check_ok",
        Kind.GAUGE,
        "Whether a check of its health found nothing wrong",
        {"check": CHECKS},
        read=True,
    ),
    Metric("edgevox_muted", Kind.GAUGE, "Whether its microphone is muted", read=True),
    Metric("edgevox_threads", Kind.GAUGE, "Threads of the process, native ones too", read=True),
    Metric(
        "edgevox_llm_fallbacks_total",
        Kind.COUNTER,
        "Questions that the model server did not answer, so that the model on board had to",
        of=SHARED,
        read={"": "llm.fallbacks"},
    ),
    Metric(
        "edgevox_llm_turned_away_total",
        Kind.COUNTER,
        "Questions for which the model server had no room",
        of=SHARED,
        read={"": "llm.turned_away"},
    ),
    Metric(
        "edgevox_llm_server_up",
        Kind.GAUGE,
        "Whether the model server is asked; 0 while it rests after a failure",
        of=SHARED,
        read={"": "llm.server_up"},
    ),
    Metric(
        "edgevox_model_weights_bytes",
        Kind.GAUGE,
        "Size of the files of the weights that are loaded; what computing needs comes on top",
        {"model": MODELS},
        read=True,
    ),
    Metric(
        "edgevox_sim_real_time_factor",
        Kind.GAUGE,
        "Seconds that pass in the simulated world each second; 0 until that is known",
        of=SIMULATED,
        read={"": "sim.real_time_factor"},
    ),
    Metric(
        "edgevox_sim_stalled_seconds",
        Kind.GAUGE,
        "For how long a step of the simulated world is due and has not come to a good end; of a"
        " robot elsewhere, for how long nothing of it is taken in",
        of=MOVES,
        read={"": "sim.stalled_s"},
    ),
    Metric(
        "edgevox_watchdog_halts_total",
        Kind.COUNTER,
        "Streams of cmd_vel that stopped while the robot was to move, so that it was halted",
        of=STEERED,
        read={"": "sim.watchdog_halts"},
    ),
    Metric(
        "edgevox_refused_messages_total",
        Kind.COUNTER,
        "Messages that were not honoured, since what they held was no valid value, by why",
        {"topic": TOPICS, "reason": tuple(Refusal)},
        of=ON_ROS2,
        read=True,
    ),
    Metric(
        "edgevox_refused_requests_total",
        Kind.COUNTER,
        "Sentences, and texts to say aloud, that were not taken, by why",
        {"reason": (Refusal.TOO_LONG, Refusal.TOO_MANY)},
        read={
            Refusal.TOO_LONG: "process.refused_too_long",
            Refusal.TOO_MANY: "process.refused_too_many",
        },
    ),
    Metric(
        "edgevox_policy_refusals_total",
        Kind.COUNTER,
        "What the policy refused, by the way in and the code of the reason",
        {"way": tuple(Way), "code": "a code that begins with policy_ or needs_"},
        read=True,
    ),
    Metric(
        "edgevox_console_bad_requests_total",
        Kind.COUNTER,
        "Requests that the console did not take, by what was wrong with them",
        {"kind": BAD_REQUESTS},
        of="an agent with a console",
        read=True,
    ),
    Metric(
        "edgevox_policy_broken",
        Kind.GAUGE,
        "Whether the policy's file cannot be used, so that the one before it is in force",
        of="an agent with a policy",
        read={"": "policy.broken"},
    ),
    Metric(
        "edgevox_executor_lag_seconds",
        Kind.GAUGE,
        "The longest that callbacks of ROS 2 had to wait, in the last minute",
        of=ON_ROS2,
        read={"": "executor.lag_s"},
    ),
    Metric(
        "edgevox_dropped_total",
        Kind.COUNTER,
        "What was lost since a queue was full: utterances, frames of sound, sentences to say,"
        " messages to record",
        {"queue": QUEUES},
        read={
            "conversation": "process.refused_too_many",
            "microphone": "audio.dropped_frames",
            "transcriber": "stt.refused",
            "speech_output": "tts.refused",
            "recorder": "recorder.dropped_messages",
        },
    ),
    Metric(
        "edgevox_recorded_messages_total",
        Kind.COUNTER,
        "Messages that are on the disk",
        of="the recorder",
        read={"": "recorder.written_messages"},
    ),
    Metric(
        "edgevox_failures_total",
        Kind.COUNTER,
        "Errors that a part survived",
        {"part": PARTS},
        read={
            "listener": "audio.failed_frames",
            "transcriber": "stt.failed",
            "speech_output": "tts.failed",
            "body": "sim.broke",
            "executor": "executor.failed_callbacks",
            "ticker": "executor.failed_ticks",
            "camera": "executor.failed_images",
            "metrics": "metrics.unreadable",
        },
    ),
)

_OF_THE_PROCESS = tuple(
    Metric(f"process_{name}", kind, about, of="every agent on Linux", read=True)
    for name, kind, about in (
        ("cpu_seconds_total", Kind.COUNTER, "CPU time that the process took"),
        ("resident_memory_bytes", Kind.GAUGE, "Memory that the process holds"),
        ("virtual_memory_bytes", Kind.GAUGE, "Addresses that the process reserved"),
        ("start_time_seconds", Kind.GAUGE, "When the process began, seconds since 1970"),
        ("open_fds", Kind.GAUGE, "File descriptors that are open"),
        ("max_fds", Kind.GAUGE, "File descriptors that may be open"),
    )
)
"""What prometheus-client's own collector says, under names that every dashboard knows."""

METRICS: Mapping[str, Metric] = {
    metric.name: metric for metric in (*_COUNTED, *_READ, *_OF_THE_PROCESS)
}
"""All metrics by name, in the order in which docs list them."""
