"""Train the stop word spotter, of all its languages, into a folder of one's own.

    python -m training.spotter.train FOLDER [--anew] [--device cuda] [--processes 8]
    python -m training.spotter.train FOLDER --install --threshold 0.8
    python -m training.spotter.train FOLDER --install es=0.7 fr=0.9

Needs PyTorch (`training/requirements.in`), in an environment of its own that sees this one's
packages. Speaks with espeak-ng, Piper and Kokoro, which takes hours the first time, and keeps what
was said; see `training/acoustics`. Of voices, sentences, noises and rooms it uses those to train
with, and nothing of those to tune and to test with. Cut off, the same command goes on.

It begins with the weights of this package, or with Whisper's encoder alone (`--anew`). It is made
for a graphics card and several cores; one core does the same with fewer `--looks` and `--steps`.

`threshold.py` and `language_thresholds.py` beside this show which thresholds to take. The package's
own weights, `edgevox/voice/stop_spotter/stop_spotter.npz` and those of the other languages beside
it, change by `--install` alone, which does without PyTorch; languages that it does not name are
left out. The benchmark `stop_words` tells how well they hear then.
"""

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from edgevox.models import locate
from edgevox.voice.stop_spotter.network import (
    ENCODER,
    LANGUAGES_FILE,
    WEIGHTS_FILE,
    read_language_weights,
    read_weights,
)
from training.acoustics import Half
from training.acoustics.clips import Clip, speak
from training.acoustics.languages import languages
from training.acoustics.noises import kinds
from training.adapter.clips import natural_clips
from training.spotter import clips as of_english
from training.spotter.installing import NotInstalled, install, install_languages
from training.spotter.language_clips import language_clips
from training.spotter.languages import ENGLISH, Outputs, sounds_of
from training.whisper.program import add_options

ROOT = Path(__file__).resolve().parents[2]
PLACE = ROOT / "edgevox" / "voice" / "stop_spotter" / WEIGHTS_FILE
STEPS, LOOKS = 5_000, 4_096
NOISES_OF_A_KIND, NOISE_S = 48, 8.0
SEED = 1


def all_clips() -> dict[str, list[Clip]]:
    """Those of each language. Of English also what Kokoro says for the hearing adapter that is no
    stop word.
    """
    beside = (clip for clip in natural_clips() if of_english.has_none(clip.text))
    english = [*dict.fromkeys((*of_english.all_clips(), *beside))]
    return {ENGLISH: english} | {one: language_clips(one) for one in sorted(languages())}


def train(folder: Path, asked: argparse.Namespace) -> None:
    """Speak what is not there yet, then let the encoder and the networks learn."""
    import torch

    from training.spotter.learning import Learning
    from training.spotter.looks import Looks
    from training.whisper.making import all_made_beside, made_beside
    from training.whisper.surroundings import noise_to_train

    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    clips = all_clips()
    if not asked.only_spoken:
        for some in clips.values():
            speak(some, told)
    spoken = {one: [clip for clip in some if clip.is_here] for one, some in clips.items()}
    for language, some in spoken.items():
        told(f"{language}: {len(some)} of {len(clips[language])} clips")
    sounds = {language: sounds_of(language, some) for language, some in spoken.items()}
    outputs = Outputs(sorted(languages()))
    every = kinds(Half.TRAIN)
    noise = partial(noise_to_train, every, NOISE_S, SEED)
    noises = all_made_beside(noise, len(every) * NOISES_OF_A_KIND, asked.processes)
    start = None if asked.anew else (read_weights(), read_language_weights())
    learning = Learning(
        locate(ENCODER), outputs, folder, asked.steps,
        looks=asked.looks, noises=noises, device=asked.device, start=start,
    )  # fmt: skip
    made = Looks(sounds, outputs, SEED + learning.course.done)
    learning.learn(made_beside(made, asked.processes), told)


def told(line: str) -> None:
    """Print it at once."""
    print(line, flush=True)


def main(arguments: Sequence[str] | None = None, place: Path = PLACE) -> int:
    """Train into the folder, or install what is there; the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where networks go")
    add_options(parser, STEPS)
    parser.add_argument("--looks", type=int, default=LOOKS, help="heard at each step")
    parser.add_argument(
        "--install", nargs="*", type=_threshold, metavar="LANGUAGE=THRESHOLD",
        help="into this package; trains nothing",
    )  # fmt: skip
    parser.add_argument("--threshold", type=float, help="of English, with --install")
    asked = parser.parse_args(arguments)
    if asked.install is None:
        train(asked.folder, asked)
        return 0
    if asked.threshold is None and not asked.install:
        parser.error("--install needs a --threshold, or thresholds of languages")
    return _exit_code_of(
        lambda: _install(asked.folder, place, asked.threshold, dict(asked.install))
    )


def _install(
    folder: Path, place: Path, threshold: float | None, thresholds: Mapping[str, float]
) -> None:
    if threshold is not None:
        install(folder / WEIGHTS_FILE, place, threshold)
        print(f"{place}: {place.stat().st_size} bytes, threshold {threshold}")
    if thresholds:
        beside = place.with_name(LANGUAGES_FILE)
        install_languages(folder / LANGUAGES_FILE, beside, thresholds)
        print(f"{beside}: {beside.stat().st_size} bytes, {thresholds}")


def _threshold(told: str) -> tuple[str, float]:
    language, _, number = told.partition("=")
    return language, float(number)


def _exit_code_of(work: Callable[[], object]) -> int:
    """Do it; the exit code, with what went wrong told."""
    try:
        work()
    except NotInstalled as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
