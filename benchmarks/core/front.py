"""What of the figures stands in the README, and what is drawn.

The README shows one run with `--front` alone; all else is of `results.json`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.core import calibration
from benchmarks.core.figures import Figure, Measured
from benchmarks.core.plots import Bar, Dot, bars, reliability
from benchmarks.core.results import BadResults, Results, Run
from benchmarks.core.tables import (
    at_commit,
    largest,
    measured,
    table,
    wanted,
)


@dataclass(frozen=True, slots=True)
class Shown:
    """One figure of a benchmark, and what it is called; its own name where that is empty."""

    benchmark: str
    figure: str
    label: str = ""

    def of(self, results: Results) -> tuple[Figure, Run]:
        """Itself, and the run that found it. Raises `BadResults`."""
        run = results.run(self.benchmark)
        return run.figure(self.figure), run

    def name(self, results: Results) -> str:
        """What it is called."""
        return self.label or self.of(results)[0].what


TYPED = (
    Shown("latency", "plain_command"),
    Shown("latency", "stop", 'typed "stop" to zero velocity while the model generates'),
)
FIRST_TOKEN = Shown("latency", "first_token", "question to the first token of a long answer")
FIRST_SOUND = Shown("voice", "first_sound", "end of speech to the first audible sample")
BARGE_IN = Shown("voice", "barge_in", "speaking over it: first voiced to last played sample")
BESIDE = (
    Shown("language_model", "first.xllamacpp", "llama-cpp-python: to the first token"),
    Shown("language_model", "rate.xllamacpp", "llama-cpp-python: each further token"),
    Shown("hearing", "time.ours", "faster-whisper, same options: an utterance"),
    Shown("ros2", "round_trip", "rclpy, a node that only echoes: a round trip"),
    Shown("ros2", "publish.bot_sentence.heard", "rclpy: publishing a sentence"),
    Shown("robots", "irsim_driving", "IR-SIM, driving: times real time"),
    Shown("robots", "panda_picking_and_placing", "MuJoCo, the arm at work: times real time"),
    Shown("robots", "humanoid_g1_walking", "MuJoCo, the G1 walking by its policy: times real time"),
)
FRONT = (
    *TYPED,
    Shown(
        "corpus", "whole.held_out.right", "sentences of strangers: understood, or rightly ignored"
    ),
    Shown("corpus", "whole.held_out.moved", "sentences of strangers, of some 800: wrong motions"),
    FIRST_SOUND,
    BARGE_IN,
    Shown(
        "voice",
        "stop",
        "end of a spoken stop word until the robot stands (negative: it stood before)",
    ),
    Shown("noise", "db10.right", "spoken commands right, noise at 10 dB"),
    Shown("noise", "db10.wrong", "wrong motions of 640 spoken commands, noise at 10 dB"),
    Shown("latency", "start", "start to ready, typed"),
    Shown("memory", "resident", "memory of the default set, hearing and speaking"),
    Shown("ros2", "idle_heard", "a standing robot whose `/tf` and `robot_state` are heard"),
    Shown("image", "image.all", "image with models and all robots"),
)
"""What a user decides by: the README's table."""


def of_the_front(name: str, found: Measured) -> Measured:
    """Of what a benchmark found, that which the README shows and what that is compared with."""
    ids = {one.figure for one in FRONT if one.benchmark == name}
    ids |= {one.baseline for one in found.figures if one.id in ids}
    return Measured(figures=tuple(one for one in found.figures if one.id in ids))


def measured_on(results: Results) -> str:
    """Where and when the README's table was measured; in bold why it is not of one version."""
    if not results.runs:
        raise BadResults("the front table was not measured: make bench ARGS=--front")
    newest = max(results.runs.values(), key=lambda run: run.measured)
    where = results.environments[newest.environment]
    told = (
        f"Measured on {where.machine}, Python {where.versions['python']}; "
        f"{newest.measured:%d %B %Y}, {at_commit(newest)}.\n"
    )
    if apart := results.apart():
        told += f"**Not of one version**: {'; '.join(apart)}. Run `make bench ARGS=--front`.\n"
    if results.quick():
        told = f"**Provisional: too few rounds to be quoted.** {told}"
    return told


def front(results: Results) -> str:
    """What a user decides by; of a benchmark whose needs were not there, that it was left out."""
    there = [one for one in FRONT if one.benchmark in results.runs]
    missing = sorted({one.benchmark for one in FRONT} - set(results.runs))
    shown = _chosen(results, there, {"median": measured, "largest": largest, "wanted": wanted})
    left_out = f"\nNot measured there: {', '.join(f'`{name}`' for name in missing)}.\n"
    return shown + (left_out if missing else "")


BLOCKS: Mapping[str, Callable[[Results], str]] = {
    "front-measured": measured_on,
    "front": front,
}


def plot_answers(results: Results) -> str:
    """How long people wait, from milliseconds to seconds."""
    chosen = (*TYPED, FIRST_TOKEN, BARGE_IN, FIRST_SOUND)
    rows = []
    for one in chosen:
        figure, _ = one.of(results)
        scale = {"ms": 1.0, "s": 1000.0}[figure.unit]
        rows.append(Bar(_bare(one.name(results)), scale * figure.value, measured(figure)))
    rows.sort(key=lambda row: row.value)
    return bars("How long one waits (median; logarithmic scale)", rows, logarithmic=True)


def plot_plain(results: Results) -> str:
    """The time that ours takes, as a multiple of the plain library's."""
    rows = []
    for one in BESIDE:
        figure, run = one.of(results)
        found = run.ratio(figure) or 0.0
        times = 1 / found if figure.more_is_better else found
        rows.append(
            Bar(_bare(one.name(results)).removesuffix(": times real time"), times, f"{times:.2f}")
        )
    return bars("Time that EdgeVox takes; the plain library takes 1", rows, mark=1.0)


def plot_calibration(results: Results) -> str:
    """How far the confidence of a decision can be believed."""
    run = results.run("corpus")
    found = [one for one in run.figures if one.table == calibration.TABLE]
    given, right = (
        [one for one in found if one.column == column]
        for column in (calibration.GIVEN, calibration.RIGHT)
    )
    dots = [Dot(x.value, y.value / 100, y.n) for x, y in zip(given, right, strict=True)]
    return reliability(
        "How often a reading was what was meant",
        "confidence: from 0.5 on it asks, from 0.8 on it acts",
        "what was meant, of the held-out half",
        dots,
    )


PLOTS: Mapping[str, Callable[[Results], str]] = {
    "figures-answers.svg": plot_answers,
    "figures-plain.svg": plot_plain,
    "figures-calibration.svg": plot_calibration,
}


def _chosen(
    results: Results,
    shown: Sequence[Shown],
    columns: Mapping[str, Callable[[Figure, Run], str]],
) -> str:
    rows = []
    for one in shown:
        figure, run = one.of(results)
        rows.append((one.name(results), *(cell(figure, run) for cell in columns.values())))
    return table(("what", *columns), rows)


def _bare(label: str) -> str:
    return label.replace("`", "")
