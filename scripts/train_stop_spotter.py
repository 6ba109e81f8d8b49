"""Train the stop word spotter, into a folder of one's own.

    python scripts/train_stop_spotter.py FOLDER [--only-spoken]
    python scripts/train_stop_spotter.py FOLDER --adapt --start WEIGHTS [--only-spoken]
    python scripts/train_stop_spotter.py FOLDER --mean WEIGHTS [WEIGHTS ...]
    python scripts/train_stop_spotter.py FOLDER --install --threshold 0.93

Needs PyTorch, which nothing else here does: `pip install torch` into an environment of its own that
sees this one's packages. Speaks with espeak-ng, Piper and Kokoro, which takes an hour the first
time, and keeps what was said; see `benchmarks/acoustics`. Of voices, sentences, noises and rooms it
uses those to train with, and nothing of those to tune and to test with. Cut off, the same command
goes on with the round that was not done: a round makes examples and learns from all so far.

The first command lets a network learn on Whisper's encoder as it is; the second, into another
folder, lets the encoder learn with it, from the weights of the first or those of the package. The
third takes the mean of several of the second, and of what those began with.

`benchmarks/stop_words_threshold.py --weights FOLDER/stop_spotter.npz` shows which threshold to
take. The package's own weights, `edgevox/voice/stop_spotter.npz`, change by `--install` alone,
which does without PyTorch; `benchmarks/stop_words.py` tells how well they hear then.
"""

import argparse
import hashlib
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "scripts")]

from acoustics.clips import Clip, speak
from hearing_adapter.clips import natural_clips
from stop_spotter import clips as of_spotter
from stop_spotter import looks, texts
from stop_spotter.examples import Example, Examples, Sound
from stop_spotter.installing import NotInstalled, average, install

from edgevox.models import locate
from edgevox.voice.stop_encoder import ENCODER, StopEncoder
from edgevox.voice.stop_network import WEIGHTS_FILE, read_weights

PLACE = ROOT / "edgevox" / "voice" / WEIGHTS_FILE
CLIPS = "clips.txt"
WEIGHTS = {"kokoro": 4.0, "piper": 4.0, "espeak": 1.0}
"""How often a clip of an engine is drawn beside the others': there are few natural voices."""
ROUNDS, EXAMPLES, STEPS = 4, 60_000, 3_200
TOLD_EVERY = 1_000
LATER = 6
"""A later round has so many times fewer examples, but looks at each all the time."""
ADAPTED, SOME, WRONG = "adapted", "some", "wrong"
"""The files of the training in which the encoder learns: networks, and two kinds of looks."""
EXAMPLES_OF_A_ROUND, LATEST = 4_000, 3
"""To look at, a few times and all along; of the latter those of so many rounds are learnt from."""


def all_clips() -> list[Clip]:
    """Those for it alone, and what Kokoro says for the hearing adapter that is no stop word."""
    beside = (clip for clip in natural_clips() if of_spotter.has_none(clip.text))
    return [*dict.fromkeys((*of_spotter.all_clips(), *beside))]


def sounds_of(clips: Sequence[Clip]) -> list[Sound]:
    """The clips, spoken."""
    return [
        Sound(
            clip.samples,
            1 + texts.WORDS.index(clip.word) if clip.word else 0,
            clip.within,
            WEIGHTS[clip.engine],
        )
        for clip in clips
    ]


def to_learn(folder: Path, clips: Sequence[Clip], only_spoken: bool) -> list[Clip]:
    """Those to train with. A training that goes on keeps those that it began with."""
    chosen = folder / CLIPS
    if not chosen.exists():
        some = [clip for clip in clips if clip.is_here or not only_spoken]
        chosen.write_text("".join(f"{_digest(clip)}\n" for clip in some), encoding="utf-8")
        return some
    known = {_digest(clip): clip for clip in clips}
    begun = chosen.read_text(encoding="utf-8").split()
    if not known.keys() >= set(begun):
        raise SystemExit(f"{chosen} has clips that are no longer trained with: take another folder")
    return [known[line] for line in begun]


def _digest(clip: Clip) -> str:
    return hashlib.sha256(repr(clip).encode()).hexdigest()[:24]


def train(folder: Path, rounds: int, examples: int, steps: int, only_spoken: bool) -> None:
    """Speak what is not there yet, then train, a round after the other; none is made twice."""
    import torch
    from stop_spotter.training import fit

    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    whole = all_clips()
    clips = to_learn(folder, whole, only_spoken)
    speak(clips, told)
    told(f"{len(clips)} of {len(whole)} clips")
    encoder, sounds = StopEncoder(locate(ENCODER), {}), sounds_of(clips)
    for number in range(rounds):
        file = network_file(folder, number)
        if not file.exists():
            if not looks.round_file(folder, number).exists():
                looks.keep(folder, number, _looks(folder, number, sounds, examples, encoder))
            fit([looks.read(folder, n) for n in range(number + 1)], steps, number, file, told)
        shutil.copy(file, folder / WEIGHTS_FILE)


def _looks(
    folder: Path, number: int, sounds: list[Sound], examples: int, encoder: StopEncoder
) -> looks.Labelled:
    """Those of a round: some of many examples, then what the network before it gets wrong."""
    made = Examples(sounds, 1 + number)
    if not number:
        return looks.some(drawn(made, examples), encoder.of, number)
    before = read_weights(network_file(folder, number - 1))
    return looks.wrong(drawn(made, examples // LATER), encoder.of, encoder, before, number)


def adapt(folder: Path, start: Path, examples: int, only_spoken: bool) -> None:
    """Let the encoder learn with the network, from the weights of `start`.

    While it learns in a round, a second process makes the looks of the next one, by the network of
    the round before.
    """
    from multiprocessing import get_context

    import torch
    from stop_spotter.adapting import ROUNDS, STEPS_OF_A_ROUND, Adapting, Drawn

    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    if not only_spoken:
        speak(all_clips(), told)
    whole = ROUNDS * STEPS_OF_A_ROUND
    learning = Adapting(locate(ENCODER), read_weights(start), folder / "adapting.pt", whole)
    for number in range(ROUNDS):
        file = network_file(folder, number, ADAPTED)
        if not file.exists():
            make_looks(folder, start, examples, number)  # unless that was cut off, they are there
            following = min(number + 1, ROUNDS - 1)  # in the last round it is there already
            asked = (folder, start, examples, following)
            beside = get_context("spawn").Process(target=make_looks, args=asked)
            beside.start()
            some, wrong = (
                [looks.read(folder, n, what) for n in range(number + 1)] for what in (SOME, WRONG)
            )
            done = (number + 1) * STEPS_OF_A_ROUND
            learning.learn(Drawn(some, wrong[-LATEST:]), done, file, told)
            beside.join()
            if beside.exitcode:
                raise SystemExit(f"the looks of round {following} were not made")
        shutil.copy(file, folder / WEIGHTS_FILE)


def make_looks(folder: Path, start: Path, examples: int, number: int) -> None:
    """Those of a round in which the encoder learns: a few at many examples, and what the network of
    two rounds before gets wrong all along others; of the clips that are spoken by then.
    """
    if looks.round_file(folder, number, WRONG).exists():
        return
    whole = all_clips()
    clips = [clip for clip in whole if clip.is_here]
    told(f"round {number}: {len(clips)} of {len(whole)} clips")
    sounds, file = sounds_of(clips), network_file(folder, number - 2, ADAPTED)
    known = read_weights(file if number > 1 else start)
    encoder = StopEncoder(locate(ENCODER), known.added)
    few = drawn(Examples(sounds, 100 + number), examples)
    looks.keep(folder, number, looks.some(few, looks.bands, number), SOME)
    many = drawn(Examples(sounds, 200 + number), examples)
    wrong = looks.wrong(many, looks.bands, encoder, known, number)
    looks.keep(folder, number, wrong, WRONG)


def drawn(made: Examples, how_many: int) -> Iterator[Example]:
    """So many of them, and how far it is."""
    for number in range(1, how_many + 1):
        yield made.make()
        if number % TOLD_EVERY == 0 or number == how_many:
            told(f"{number} of {how_many} examples")


def network_file(folder: Path, number: int, what: str = "network") -> Path:
    """The network of a round."""
    return folder / f"{what}{number}.npz"


def told(line: str) -> None:
    """Print it at once."""
    print(line, flush=True)


def main(arguments: Sequence[str] | None = None, place: Path = PLACE) -> int:
    """Train into the folder, or install what is there; the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where examples and networks go")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="the first, and then by errors")
    parser.add_argument("--examples", type=int, default=EXAMPLES, help="of the first round")
    parser.add_argument("--steps", type=int, default=STEPS, help="to learn in each round")
    parser.add_argument("--adapt", action="store_true", help="let the encoder learn, too")
    parser.add_argument("--start", type=Path, help="with --adapt: from these weights")
    parser.add_argument("--only-spoken", action="store_true", help="only what was spoken before")
    parser.add_argument("--mean", type=Path, nargs="+", metavar="WEIGHTS", help="trains nothing")
    parser.add_argument("--install", action="store_true", help="into this package; trains nothing")
    parser.add_argument("--threshold", type=float, help="from which a word counts, with --install")
    asked = parser.parse_args(arguments)
    if asked.adapt:
        if asked.start is None:
            parser.error("--adapt needs --start: the weights that --install would take")
        adapt(asked.folder, asked.start, EXAMPLES_OF_A_ROUND, asked.only_spoken)
        return 0
    if asked.mean:
        asked.folder.mkdir(parents=True, exist_ok=True)
        return exit_code_of(lambda: average(asked.mean, asked.folder / WEIGHTS_FILE))
    if not asked.install:
        train(asked.folder, asked.rounds, asked.examples, asked.steps, asked.only_spoken)
        return 0
    if asked.threshold is None:
        parser.error("--install needs a --threshold: benchmarks/stop_words_threshold.py shows some")
    if code := exit_code_of(lambda: install(asked.folder / WEIGHTS_FILE, place, asked.threshold)):
        return code
    print(f"{place}: {place.stat().st_size} bytes, threshold {asked.threshold}")
    return 0


def exit_code_of(work: Callable[[], object]) -> int:
    """Do it; the exit code, with what went wrong told."""
    try:
        work()
    except NotInstalled as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
