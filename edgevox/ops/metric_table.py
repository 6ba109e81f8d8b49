"""Every metric, once. Code, docs, dashboard, alerts and tests read this table."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from edgevox.core.agent_events import GOAL_ENDS
from edgevox.core.commands import Way
from edgevox.core.errors import Refusal
from edgevox.core.events import Cause, Outcome, State


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


SKILLS, CHECKS, TOPICS = "the agent's skills", "the checks of health", "incoming topics"
STAGES = ("stt", "llm", "tts", "ttfs", "total")
SOURCES = ("template", "reading", "command", "action", "program")
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
BAD_REQUESTS = (
    *("http", "tls", "connection", "cookie", "origin"),
    *("host", "code", "message", "crowd"),
)
MODELS = ("stt", "llm", "tts")

SIMULATED, MOVES = "a simulated body", "an agent with a body"
ALOUD, ON_ROS2 = "an agent with a voice", "an agent on ROS 2"
STEERED = "a body that takes velocities"

SHORT_S = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 60.0)
LONG_S = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0)

_COUNTED = (
    Metric(
        "edgevox_turns_total",
        Kind.COUNTER,
        "Turns that began with words, by outcome",
        {"outcome": tuple(Outcome)},
    ),
    Metric(
        "edgevox_turn_stage_seconds",
        Kind.HISTOGRAM,
        "Duration of the stages of a turn; ttfs is the time to the first sign of an answer, total"
        " the time to its end; unused stages are not counted",
        {"stage": STAGES},
        SHORT_S,
    ),
    Metric(
        "edgevox_llm_tokens_total",
        Kind.COUNTER,
        "Tokens that language models generated for turns; an estimate if a server answers",
    ),
    Metric(
        "edgevox_skill_calls_total",
        Kind.COUNTER,
        "Calls of skills, by the source of the call",
        {"source": SOURCES},
    ),
    Metric(
        "edgevox_skill_goals_total",
        Kind.COUNTER,
        "Goals of skills that ended, by outcome",
        {"skill": SKILLS, "outcome": GOAL_ENDS},
    ),
    Metric(
        "edgevox_skill_goals_running",
        Kind.GAUGE,
        "Goals of skills that are running",
        {"skill": SKILLS},
    ),
    Metric(
        "edgevox_skill_goal_seconds",
        Kind.HISTOGRAM,
        "Duration of goals, for every outcome",
        {"skill": SKILLS},
        LONG_S,
    ),
    Metric(
        "edgevox_interrupts_total",
        Kind.COUNTER,
        "Requests for silence or a halt, by cause",
        {"cause": tuple(Cause)},
    ),
    Metric(
        "edgevox_safety_stops_total",
        Kind.COUNTER,
        "Stop words, spoken or typed, that stopped something",
    ),
    Metric("edgevox_wake_words_total", Kind.COUNTER, "Wake words that EdgeVox heard", of=ALOUD),
    Metric(
        "edgevox_state",
        Kind.GAUGE,
        "State of the conversation: 1 for the current state, 0 for the others",
        {"state": tuple(State)},
    ),
)

_SERVERS = tuple(
    metric
    for part, asks, here in (
        ("llm", "Questions", "the model on board answered"),
        ("stt", "Utterances", "the model on board transcribed"),
        ("tts", "Phrases", "a voice on board spoke"),
    )
    for metric in (
        Metric(
            f"edgevox_{part}_fallbacks_total",
            Kind.COUNTER,
            f"{asks} that {here} because the server of `{part}_endpoint` did not",
            of=f"an agent with `{part}_endpoint`",
            read={"": f"{part}.fallbacks"},
        ),
        Metric(
            f"edgevox_{part}_turned_away_total",
            Kind.COUNTER,
            f"{asks} that the full server of `{part}_endpoint` turned away",
            of=f"an agent with `{part}_endpoint`",
            read={"": f"{part}.turned_away"},
        ),
        Metric(
            f"edgevox_{part}_server_up",
            Kind.GAUGE,
            f"1 if EdgeVox asks the server of `{part}_endpoint`; 0 during a pause after a failure",
            of=f"an agent with `{part}_endpoint`",
            read={"": f"{part}.server_up"},
        ),
    )
)
"""What is told of each server that a robot asks before its own models."""

_READ = (
    Metric(
        "edgevox_build_info",
        Kind.GAUGE,
        "Always 1; the labels give the version, the agent and its language",
        {"version": "a version", "agent": "the name of a robot or a program", "language": "a code"},
        read=True,
    ),
    Metric("edgevox_ready", Kind.GAUGE, "1 if the agent is ready, as /ready reports", read=True),
    Metric(
        "edgevox_check_ok",
        Kind.GAUGE,
        "1 if this health check passes",
        {"check": CHECKS},
        read=True,
    ),
    Metric("edgevox_muted", Kind.GAUGE, "1 if the microphone is muted", read=True),
    Metric(
        "edgevox_threads", Kind.GAUGE, "Threads of the process, including native ones", read=True
    ),
    *_SERVERS,
    Metric(
        "edgevox_model_weights_bytes",
        Kind.GAUGE,
        "File size of the loaded weights; computing needs more memory",
        {"model": MODELS},
        read=True,
    ),
    Metric(
        "edgevox_sim_real_time_factor",
        Kind.GAUGE,
        "Simulated seconds per real second; 0 until it is known",
        of=SIMULATED,
        read={"": "sim.real_time_factor"},
    ),
    Metric(
        "edgevox_sim_stalled_seconds",
        Kind.GAUGE,
        "Seconds that a step of the simulated world is overdue; for an external robot, seconds in"
        " which EdgeVox took in none of its messages",
        of=MOVES,
        read={"": "sim.stalled_s"},
    ),
    Metric(
        "edgevox_watchdog_halts_total",
        Kind.COUNTER,
        "Halts because a stream of cmd_vel stopped while the robot was to move",
        of=STEERED,
        read={"": "sim.watchdog_halts"},
    ),
    Metric(
        "edgevox_refused_messages_total",
        Kind.COUNTER,
        "Messages refused for an invalid value, by reason",
        {"topic": TOPICS, "reason": tuple(Refusal)},
        of=ON_ROS2,
        read=True,
    ),
    Metric(
        "edgevox_refused_requests_total",
        Kind.COUNTER,
        "Sentences and texts to say that were refused, by reason",
        {"reason": (Refusal.TOO_LONG, Refusal.TOO_MANY)},
        read={
            Refusal.TOO_LONG: "process.refused_too_long",
            Refusal.TOO_MANY: "process.refused_too_many",
        },
    ),
    Metric(
        "edgevox_policy_refusals_total",
        Kind.COUNTER,
        "Requests that the policy refused, by way in and code of the reason",
        {"way": tuple(Way), "code": "a code that starts with policy_ or needs_"},
        read=True,
    ),
    Metric(
        "edgevox_console_bad_requests_total",
        Kind.COUNTER,
        "Requests that the console refused, by fault",
        {"kind": BAD_REQUESTS},
        of="an agent with a console",
        read=True,
    ),
    Metric(
        "edgevox_policy_broken",
        Kind.GAUGE,
        "1 if the policy file cannot be used and the previous policy is in force",
        of="an agent with a policy",
        read={"": "policy.broken"},
    ),
    Metric(
        "edgevox_executor_lag_seconds",
        Kind.GAUGE,
        "Longest wait of a ROS 2 callback in the last minute",
        of=ON_ROS2,
        read={"": "executor.lag_s"},
    ),
    Metric(
        "edgevox_dropped_total",
        Kind.COUNTER,
        "Items lost because a queue was full: utterances, audio frames, sentences to say,"
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
        "Messages that the recorder wrote to the disk",
        of="the recorder",
        read={"": "recorder.written_messages"},
    ),
    Metric(
        "edgevox_recordings_bytes",
        Kind.GAUGE,
        "Size of all recordings in the recorder's folder",
        of="the recorder",
        read={"": "recorder.used_bytes"},
    ),
    Metric(
        "edgevox_recordings_free_bytes",
        Kind.GAUGE,
        "Free space on the disk of the recordings",
        of="the recorder",
        read={"": "recorder.free_bytes"},
    ),
    Metric(
        "edgevox_recordings_upload_failed",
        Kind.GAUGE,
        "1 while uploads of recordings fail, or have been behind for 2 hours",
        of="the recorder",
        read={"": "recorder.upload_failed"},
    ),
    Metric(
        "edgevox_failures_total",
        Kind.COUNTER,
        "Errors that a part recovered from",
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
        ("cpu_seconds_total", Kind.COUNTER, "CPU time of the process"),
        ("resident_memory_bytes", Kind.GAUGE, "Resident memory of the process"),
        ("virtual_memory_bytes", Kind.GAUGE, "Virtual memory of the process"),
        ("start_time_seconds", Kind.GAUGE, "Start time of the process, in seconds since 1970"),
        ("open_fds", Kind.GAUGE, "Open file descriptors"),
        ("max_fds", Kind.GAUGE, "Limit of open file descriptors"),
    )
)
"""What prometheus-client's own collector says, under names that every dashboard knows."""

METRICS: Mapping[str, Metric] = {
    metric.name: metric for metric in (*_COUNTED, *_READ, *_OF_THE_PROCESS)
}
"""All metrics by name, in the order in which docs list them."""
