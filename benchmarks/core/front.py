"""What of the figures stands in the README and at the head of their page, and what is drawn.

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
    beside,
    largest,
    measured,
    number,
    ratio,
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


ANSWERS = (
    Shown("latency", "plain_command"),
    Shown("latency", "stop", 'typed "stop" to zero velocity while the model generates'),
    Shown("latency", "first_token", "question to the first token of a long answer"),
    START := Shown("latency", "start", "start to ready, typed"),
    Shown("latency", "memory_bare"),
    Shown("latency", "memory_small"),
    MEMORY := Shown("memory", "resident", "memory of the default set, hearing and speaking"),
    IDLE := Shown("ros2", "idle_heard", "a standing robot whose `/tf` and `robot_state` are heard"),
)
VOICE = (
    Shown("voice", "word_errors"),
    Shown("voice", "first_sound", "end of speech to the first audible sample"),
    Shown("voice", "silence"),
    Shown("voice", "to_floor", "the same without that silence, against the parts one by one"),
    Shown("voice", "long_to_floor", "an answer of three sentences or more, against them"),
    Shown("voice", "barge_in", "speaking over it: first voiced to last played sample"),
    Shown("voice", "listening_with", "listening to silence for a wake word"),
    Shown("voice", "hour_late_memory", "an hour of sound: growth of memory in its last quarter"),
    Shown("voice", "hour_threads", "an hour of sound: growth of threads"),
)
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
OVERHEAD = (
    Shown("overhead", "rest.more", "at rest, of a core"),
    Shown("overhead", "model.work.more", "of the time of a sentence for the model"),
    Shown("overhead", "plain.work.more", "of the time of a typed plain command"),
)
STRANGERS = (
    Shown(
        "corpus", "whole.held_out.right", "sentences of strangers: understood, or rightly ignored"
    ),
    Shown("corpus", "whole.held_out.moved", "sentences of strangers, of some 800: wrong motions"),
)
DECIDED = (
    *STRANGERS,
    Shown("corpus", "whole.held_out.asked", "sentences of strangers: asked back"),
    Shown("corpus", "whole.held_out.time_template"),
    Shown("corpus", "whole.held_out.time_reading"),
    Shown("corpus", "whole.held_out.p95", "time to decide, 95th percentile"),
)
SPOKEN = (
    Shown(
        "voice",
        "stop",
        "end of a spoken stop word until the robot stands (negative: it stood before)",
    ),
    Shown("noise", "db10.right", "spoken commands right, noise at 10 dB"),
    Shown("noise", "db10.wrong", "wrong motions of 640 spoken commands, noise at 10 dB"),
)
CONTAINER = (
    Shown("image", "image.all", "image with models and all robots"),
    Shown("image", "slim.all", "slim image"),
    Shown("image", "ready"),
)
FRONT = (
    *ANSWERS[:2],
    *STRANGERS,
    *(VOICE[at] for at in (1, 5)),
    *SPOKEN,
    START,
    MEMORY,
    IDLE,
    CONTAINER[0],
)
"""What a user decides by: the README's table."""
BODIES = (
    ("`robot-apartment`, driving", "apartment_driving", "step"),
    ("`robot-irsim`, driving", "irsim_driving", "added"),
    ("`robot-panda`, picking and placing", "panda_picking_and_placing", "added"),
    ("`robot-humanoid`, walking", "humanoid_g1_walking", "added"),
)


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


def answers(results: Results) -> str:
    """How soon it answers and stops, typed; what it takes."""
    return _chosen(results, ANSWERS, {"median": measured, "largest": largest, "wanted": wanted})


def voice(results: Results) -> str:
    """How well and how soon it hears and speaks."""
    return _chosen(results, VOICE, {"median": measured, "largest": largest, "wanted": wanted})


def overhead(results: Results) -> str:
    """What watching it costs."""
    return _chosen(results, OVERHEAD, {"measured": measured, "wanted": wanted})


def container(results: Results) -> str:
    """What the image weighs and how fast it starts."""
    return _chosen(results, CONTAINER, {"measured": measured, "wanted": wanted})


def plain(results: Results) -> str:
    """Ours beside the plain library."""
    return _chosen(results, BESIDE, {"plain": beside, "ours": measured, "ratio": ratio})


def bodies(results: Results) -> str:
    """How fast the worlds are, with and without us."""
    run = results.run("robots")
    rows = []
    for label, name, added in BODIES:
        parts = (name, f"{name}.alone", f"{name}.{added}", f"{name}.added_by_all")
        figures = [run.figure(one) for one in parts]
        cells = [number(one.value) for one in figures[:2]] + [measured(one) for one in figures[2:]]
        rows.append((label, *cells))
    heads = ("seconds of the world for one of the processor", "the simulator alone")
    return table(("body", *heads, "our layer adds", "with all it thinks and plans"), rows)


def decided(results: Results) -> str:
    """What becomes of sentences that nothing was tuned to."""
    return _chosen(results, DECIDED, {"measured": measured, "wanted": wanted})


BLOCKS: Mapping[str, Callable[[Results], str]] = {
    "front-measured": measured_on,
    "front": front,
    "short-answers": answers,
    "short-voice": voice,
    "short-overhead": overhead,
    "short-container": container,
    "short-plain": plain,
    "short-bodies": bodies,
    "short-decided": decided,
}


def plot_answers(results: Results) -> str:
    """How long people wait, from milliseconds to seconds."""
    chosen = (*ANSWERS[:3], VOICE[5], VOICE[1])
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
