"""Train the adapter with which Whisper hears through noise, into a folder of one's own.

    python scripts/train_hearing_adapter.py FOLDER [--only-spoken]
    python scripts/train_hearing_adapter.py FOLDER --install

Needs PyTorch, which nothing else here does: `pip install torch` into an environment of its own that
sees this one's packages. Speaks with espeak-ng, Piper and Kokoro, which takes an hour the first
time, and keeps what was said; see `benchmarks/acoustics`. Of voices, sentences, noises and rooms it
uses those to train with, and nothing of those to tune and to test with. Cut off, the same command
goes on.

The package's own adapter, `edgevox/voice/stt/adapter.npz`, changes by `--install` alone, which does
without PyTorch; `benchmarks/noise.py` tells how well it hears then.
"""

import argparse
import hashlib
import queue
import sys
import threading
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "scripts")]

from acoustics.clips import speak
from hearing_adapter.clips import all_clips
from whisper_training.whole_file import write_whole

from edgevox.models import locate
from edgevox.voice.stt.adapter import ADAPTER_FILE, MODEL, SIZE
from edgevox.voice.whisper_file import FILE, UP, NotAWhisperFile, adapted, added_of

if TYPE_CHECKING:
    from hearing_adapter.batches import Batch, Batches

WHISPER = "whisper-tiny.en"
PLACE = ROOT / "edgevox" / "voice" / "stt" / ADAPTER_FILE
STEPS = 1_500
ANEW_EVERY = 150
"""After so many batches other noises are made, of the clips that are spoken by then."""
_WAITING = 3
ADDED_SHARE = 0.8
"""So much of what was learnt is added: less of it than all forgets less of what Whisper knew, and
more commands of the voices that tune were right.
"""


def train(folder: Path, steps: int, only_spoken: bool) -> None:
    """Speak what is not there yet, then learn."""
    import torch
    from hearing_adapter.batches import Batches
    from hearing_adapter.learning import Learning

    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    if not only_spoken:
        speak(all_clips(), _told)
    model = locate(WHISPER)
    kept = folder / "learning.pt"
    learning = Learning(model, Batches(model, 0).no_speech, kept, folder / ADAPTER_FILE, steps)
    learning.learn(_batches(Batches(model, learning.done), learning.done), _told)


def _batches(batches: "Batches", seed: int) -> Iterator["Batch"]:
    """Made on a thread beside the one that learns."""
    made: queue.Queue[Batch] = queue.Queue(_WAITING)

    def make() -> None:
        for batch in _made(batches, seed):
            made.put(batch)

    threading.Thread(target=make, daemon=True).start()
    while True:
        yield made.get()


def _made(batches: "Batches", seed: int) -> Iterator["Batch"]:
    from hearing_adapter.utterances import Utterances

    while True:
        clips = [clip for clip in all_clips() if clip.is_here or clip.engine != "kokoro"]
        _told(f"{len(clips)} clips")
        utterances, number = Utterances(clips, seed), 0
        while number < ANEW_EVERY:
            for batch in batches.of(utterances):
                yield batch
                number += 1
        seed += 1


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
    parser.add_argument("--steps", type=int, default=STEPS, help="to learn in all")
    parser.add_argument("--only-spoken", action="store_true", help="only what was spoken before")
    parser.add_argument("--install", action="store_true", help="into this package; trains nothing")
    asked = parser.parse_args(arguments)
    if not asked.install:
        train(asked.folder, asked.steps, asked.only_spoken)
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
