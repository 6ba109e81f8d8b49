"""Train the stop word spotter in the languages other than English, into a folder of one's own.

    python scripts/train_stop_languages.py FOLDER [--only-spoken]
    python scripts/train_stop_languages.py FOLDER --install LANGUAGE=THRESHOLD [...]

Needs PyTorch, as `train_stop_spotter.py` does, and the encoder of the package's English weights:
where those change, this is to be done again. What voices say is in
`benchmarks/acoustics/languages.toml`; those of the part to train with say it. Cut off, the same
command goes on with the language whose looks were not made.

`benchmarks/stop_words_languages.py --thresholds --weights FOLDER/stop_spotter_languages.npz` shows
which thresholds to take. The package's own weights change by `--install` alone.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "scripts")]

from acoustics.clips import Clip, speak
from acoustics.languages import is_native, languages, words
from stop_spotter import looks
from stop_spotter.examples import Examples, Sound
from stop_spotter.installing import install_languages
from stop_spotter.language_clips import language_clips
from train_stop_spotter import PLACE as ENGLISH
from train_stop_spotter import WEIGHTS, drawn, exit_code_of, told

from edgevox.models import locate
from edgevox.voice.stop_encoder import ENCODER, StopEncoder
from edgevox.voice.stop_network import LANGUAGES_FILE, read_weights

PLACE = ENGLISH.with_name(LANGUAGES_FILE)
EXAMPLES, STEPS = 8_000, 2_500
"""Of each language, and to learn all of them together. To learn again what was wrong, as in
English, was tried and made it no better."""
NATIVE = 2.0
"""How often a clip of a native voice is drawn beside another of Kokoro's."""


def sounds_of(language: str, clips: Sequence[Clip]) -> list[Sound]:
    """The clips, spoken."""
    known = ("", *words(language))
    return [
        Sound(
            clip.samples, known.index(clip.word), clip.within,
            WEIGHTS[clip.engine] * (NATIVE if is_native(clip.voice, language) else 1),
        )
        for clip in clips
    ]  # fmt: skip


def train(folder: Path, only_spoken: bool) -> None:
    """Speak what is not there yet, make looks of each language, then learn from all of them."""
    import torch
    from stop_spotter.languages import fit_languages

    torch.set_num_threads(1)
    if not only_spoken:
        for language in languages():
            speak(language_clips(language), told)
    for language in languages():
        make_looks(folder / language, language)
    learnt = {one: looks.read(folder / one, 0) for one in languages()}
    fit_languages(learnt, STEPS, folder / LANGUAGES_FILE, told)


def make_looks(folder: Path, language: str) -> None:
    """Some at many examples in one language, unless they are there."""
    if looks.round_file(folder, 0).exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    whole = language_clips(language)
    clips = [clip for clip in whole if clip.is_here]
    told(f"{language}: {len(clips)} of {len(whole)} clips")
    encoder = StopEncoder(locate(ENCODER), read_weights().added)
    made = drawn(Examples(sounds_of(language, clips), 1), EXAMPLES)
    looks.keep(folder, 0, looks.some(made, encoder.of, 0))


def main(arguments: Sequence[str] | None = None, place: Path = PLACE) -> int:
    """Train into the folder, or install what is there; the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where examples and networks go")
    parser.add_argument("--only-spoken", action="store_true", help="only what was spoken before")
    parser.add_argument("--install", nargs="+", type=_threshold, metavar="LANGUAGE=THRESHOLD")
    asked = parser.parse_args(arguments)
    if asked.install is None:
        train(asked.folder, asked.only_spoken)
        return 0
    thresholds = dict(asked.install)
    if code := exit_code_of(
        lambda: install_languages(asked.folder / LANGUAGES_FILE, place, thresholds)
    ):
        return code
    print(f"{place}: {place.stat().st_size} bytes, {thresholds}")
    return 0


def _threshold(told: str) -> tuple[str, float]:
    language, _, number = told.partition("=")
    return language, float(number)


if __name__ == "__main__":
    sys.exit(main())
