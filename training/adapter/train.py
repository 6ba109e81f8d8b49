"""Train the adapter with which Whisper hears through noise, into a folder of one's own.

    python -m training.adapter.train FOLDER [--anew] [--device cuda] [--processes 8]
    python -m training.adapter.train FOLDER --install

Needs PyTorch (`training/requirements.in`), in an environment of its own that sees this one's
packages. Speaks with espeak-ng, Piper and Kokoro, which takes an hour the first time, and keeps
what was said; see `training/acoustics`. Of voices, sentences, noises and rooms it uses those to
train with, and nothing of those to tune and to test with. Cut off, the same command goes on.

The package's own adapter, `edgevox/voice/stt/adapter.npz`, changes by `--install` alone, which does
without PyTorch; the benchmark `noise` tells how well it hears then.
"""

import argparse
import hashlib
import sys
from collections.abc import Sequence
from functools import partial
from io import BytesIO
from pathlib import Path

import numpy as np

from edgevox.models import locate
from edgevox.voice.stt.adapter import (
    ADAPTER_FILE,
    FILE,
    MODEL,
    SIZE,
    UP,
    NotAWhisperFile,
    adapted,
    adapter_for,
    added_of,
)
from training.acoustics import Half
from training.acoustics.clips import speak
from training.acoustics.noises import BABBLE, kinds
from training.adapter.clips import all_clips
from training.adapter.utterances import NOISE_S
from training.whisper.program import add_options, write_whole

WHISPER = "whisper-tiny.en"
ROOT = Path(__file__).resolve().parents[2]
PLACE = ROOT / "edgevox" / "voice" / "stt" / ADAPTER_FILE
STEPS, UTTERANCES = 5_000, 160
NOISES_OF_A_KIND, NATURAL_BABBLES, SEED = 24, 48, 1
ADDED_SHARE = 0.85
"""So much of what was learnt is added: less of it than all forgets less of what Whisper knew, and
more commands of the voices that tune were right.
"""


def train(folder: Path, asked: argparse.Namespace) -> None:
    """Speak what is not there yet, then learn."""
    import torch

    from training.adapter.batches import Batches, babble
    from training.adapter.learning import Learning
    from training.whisper.making import all_made_beside, made_beside
    from training.whisper.surroundings import noise_to_train

    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    whole = all_clips()
    if not asked.only_spoken:
        speak(whole, _told)
    clips = [clip for clip in whole if clip.is_here]
    _told(f"{len(clips)} of {len(whole)} clips")
    model = locate(WHISPER)
    every = [*kinds(Half.TRAIN), BABBLE]  # babble twice
    noise = partial(noise_to_train, every, NOISE_S, SEED)
    around = (noise, len(every) * NOISES_OF_A_KIND), (partial(babble, clips), NATURAL_BABBLES)
    noises = torch.cat([all_made_beside(*some, asked.processes) for some in around])
    start = {} if asked.anew else adapter_for(model)
    learning = Learning(model, folder, asked.steps, noises=noises, device=asked.device, start=start)
    made = Batches(model, clips, asked.utterances, learning.course.done)
    learning.learn(made_beside(made, asked.processes), _told)


def install(trained: Path, model: Path, place: Path) -> None:
    """Write what was learnt to its place, whole or not at all.

    Raises `NotAWhisperFile` if it does not fit the model in this folder, `OSError`, and
    `ValueError` and `KeyError` for a file that is none of the training.
    """
    with np.load(BytesIO(trained.read_bytes())) as data:
        arrays = dict(data)
    if not all(np.all(np.isfinite(one)) for one in arrays.values()):
        raise NotAWhisperFile(f"{trained}: some of it is no number")
    arrays |= {
        name: one * one.dtype.type(ADDED_SHARE) for name, one in arrays.items() if name.endswith(UP)
    }
    adapted(model, added_of(arrays))
    held = (model / FILE).read_bytes()
    digest = hashlib.sha256(held).hexdigest()
    arrays |= {MODEL: np.array(digest), SIZE: np.array(len(held))}
    write_whole(place, lambda out: np.savez(out, **arrays))


def _told(line: str) -> None:
    print(line, flush=True)


def main(arguments: Sequence[str] | None = None, place: Path = PLACE) -> int:
    """Train into the folder, or install what is there; the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where what is learnt goes")
    add_options(parser, STEPS)
    parser.add_argument("--utterances", type=int, default=UTTERANCES, help="learnt from at once")
    parser.add_argument("--install", action="store_true", help="into this package; trains nothing")
    asked = parser.parse_args(arguments)
    if not asked.install:
        train(asked.folder, asked)
        return 0
    try:
        install(asked.folder / ADAPTER_FILE, locate(WHISPER), place)
    except (NotAWhisperFile, OSError, ValueError, KeyError) as error:
        print(f"not installed: {error}", file=sys.stderr)
        return 1
    print(f"{place}: {place.stat().st_size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
