"""What Grafana's dashboard shows, as data: rows of panels, each with its expressions."""

from collections.abc import Sequence
from dataclasses import dataclass

R = 'robot=~"$robot"'
"""The robots that were chosen."""
SPAN = "[$__rate_interval]"


@dataclass(frozen=True)
class Panel:
    """What one picture shows: expressions, each with what its lines are called."""

    title: str
    queries: Sequence[tuple[str, str]]
    unit: str = "short"
    kind: str = "timeseries"
    width: int = 8
    words: Sequence[tuple[str, str, str]] = ()
    """Values that are shown as a word, in a colour."""
    stacked: bool = False


def rate(name: str, by: str, labels: str = "") -> str:
    """How often something happens, by a label."""
    return f"sum by (robot, {by}) (rate({name}{{{R}{labels}}}{SPAN}))"


def quantile(share: float, name: str, by: str, labels: str = "") -> str:
    """How long most of something took, by a label."""
    chosen = f"rate({name}_bucket{{{R}{labels}}}{SPAN})"
    return f"histogram_quantile({share}, sum by (le, robot, {by}) ({chosen}))"


YES_NO = (("0", "no", "red"), ("1", "yes", "green"))
ROWS: Sequence[tuple[str, Sequence[Panel]]] = (
    (
        "Now",
        (
            Panel("Ready", [(f"edgevox_ready{{{R}}}", "{{robot}}")], "none", "stat", 6, YES_NO),
            Panel(
                "Checks that fail",
                [(f"edgevox_check_ok{{{R}}} == 0", "{{robot}}: {{check}}")],
                "none",
                "stat",
                6,
                (("0", "fails", "red"),),
            ),
            Panel(
                "State", [(f"edgevox_state{{{R}}} == 1", "{{robot}}: {{state}}")], "none", "stat", 6
            ),
            Panel(
                "What runs",
                [(f"edgevox_build_info{{{R}}}", "{{robot}}: {{agent}} {{version}}, {{language}}")],
                "none",
                "stat",
                6,
            ),
        ),
    ),
    (
        "The conversation",
        (
            Panel(
                "Turns",
                [(rate("edgevox_turns_total", "outcome"), "{{outcome}}")],
                "cps",
                stacked=True,
            ),
            Panel(
                "Until the first sign of an answer",
                [
                    (
                        quantile(0.5, "edgevox_turn_stage_seconds", "stage", ', stage="ttfs"'),
                        "half",
                    ),
                    (
                        quantile(0.95, "edgevox_turn_stage_seconds", "stage", ', stage="ttfs"'),
                        "95 %",
                    ),
                ],
                "s",
            ),
            Panel(
                "Stages of a turn, 95 %",
                [(quantile(0.95, "edgevox_turn_stage_seconds", "stage"), "{{stage}}")],
                "s",
            ),
            Panel(
                "Tokens",
                [(f"sum by (robot) (rate(edgevox_llm_tokens_total{{{R}}}{SPAN}))", "{{robot}}")],
                "cps",
            ),
            Panel(
                "Interrupts",
                [(rate("edgevox_interrupts_total", "cause"), "{{cause}}")],
                "cps",
                stacked=True,
            ),
            Panel(
                "Safety stops and wake words, an hour",
                [
                    (
                        f"sum by (robot) (increase(edgevox_safety_stops_total{{{R}}}[1h]))",
                        "stops {{robot}}",
                    ),
                    (
                        f"sum by (robot) (increase(edgevox_wake_words_total{{{R}}}[1h]))",
                        "wakes {{robot}}",
                    ),
                ],
            ),
        ),
    ),
    (
        "What it does",
        (
            Panel(
                "Goals running",
                [(f"sum by (robot, skill) (edgevox_skill_goals_running{{{R}}})", "{{skill}}")],
            ),
            Panel(
                "Goals that ended",
                [(rate("edgevox_skill_goals_total", "skill, outcome"), "{{skill}} {{outcome}}")],
                "cps",
                stacked=True,
            ),
            Panel(
                "How long goals run, half",
                [(quantile(0.5, "edgevox_skill_goal_seconds", "skill"), "{{skill}}")],
                "s",
            ),
            Panel(
                "Who called",
                [(rate("edgevox_skill_calls_total", "source"), "{{source}}")],
                "cps",
                stacked=True,
            ),
            Panel(
                "Real-time factor",
                [(f"edgevox_sim_real_time_factor{{{R}}}", "{{robot}}")],
                "percentunit",
            ),
            Panel("World stalled", [(f"edgevox_sim_stalled_seconds{{{R}}}", "{{robot}}")], "s"),
            Panel(
                "Watchdog halts, an hour",
                [(f"increase(edgevox_watchdog_halts_total{{{R}}}[1h])", "{{robot}}")],
            ),
            Panel(
                "Messages refused",
                [
                    (
                        rate("edgevox_refused_messages_total", "topic, reason"),
                        "{{topic}} {{reason}}",
                    ),
                    (rate("edgevox_refused_requests_total", "reason"), "sentences {{reason}}"),
                ],
                "cps",
            ),
            Panel(
                "ROS 2 callbacks wait", [(f"edgevox_executor_lag_seconds{{{R}}}", "{{robot}}")], "s"
            ),
        ),
    ),
    (
        "What goes wrong",
        (
            Panel("Dropped", [(rate("edgevox_dropped_total", "queue"), "{{queue}}")], "cps"),
            Panel(
                "Recorded",
                [
                    (
                        f"sum by (robot) (rate(edgevox_recorded_messages_total{{{R}}}{SPAN}))",
                        "{{robot}}",
                    )
                ],
                "cps",
            ),
            Panel(
                "Failures survived", [(rate("edgevox_failures_total", "part"), "{{part}}")], "cps"
            ),
            Panel(
                "Model server",
                [
                    (f"edgevox_llm_server_up{{{R}}}", "asked: {{robot}}"),
                    (
                        f"increase(edgevox_llm_fallbacks_total{{{R}}}[1h])",
                        "fallbacks an hour: {{robot}}",
                    ),
                ],
            ),
        ),
    ),
    (
        "The process",
        (
            Panel(
                "CPU",
                [(f"rate(process_cpu_seconds_total{{{R}}}{SPAN})", "{{robot}}")],
                "percentunit",
            ),
            Panel(
                "Memory",
                [
                    (f"process_resident_memory_bytes{{{R}}}", "held: {{robot}}"),
                    (f"edgevox_model_weights_bytes{{{R}}}", "weights: {{model}}"),
                ],
                "bytes",
            ),
            Panel(
                "Threads and open files",
                [
                    (f"edgevox_threads{{{R}}}", "threads {{robot}}"),
                    (f"process_open_fds{{{R}}}", "files {{robot}}"),
                ],
            ),
        ),
    ),
)
