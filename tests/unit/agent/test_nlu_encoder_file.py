"""The packed file of the encoder: read as it is written, refused when it is something else."""

from pathlib import Path

import numpy as np
import pytest

from edgevox.agent.nlu.encoder import Packed, Pieces, Vocabulary
from edgevox.core.errors import InvalidValue


def test_a_file_of_another_kind_is_refused_by_its_name(tmp_path: Path) -> None:
    file = tmp_path / "other.bin"
    file.write_bytes(b"GGUF" + bytes(100))

    with pytest.raises(InvalidValue, match=r"other\.bin"):
        Packed(file)


def test_a_sentence_becomes_the_likeliest_pieces() -> None:
    pieces = ["<s>", "</s>", "<unk>", "\u2581go", "\u2581", "g", "o", "\u2581to"]
    scores = np.array([0, 0, 0, -1, -4, -5, -5, -2], np.float32)
    ids = {piece.encode(): number for number, piece in enumerate(pieces)}
    known = Vocabulary(ids, scores, 5, {ord("G"): "g"}, begin=0, end=1, unknown=2)

    assert Pieces(known).ids("Go  to") == [0, 3, 7, 1]
    assert Pieces(known).ids("go \u2603") == [0, 3, 4, 2, 1]
