"""The encoder that judges sentences: whatever is wrong with its file, the robot comes up."""

import pytest

from edgevox.agent.nlu.encoder import MAGIC, Encoder
from edgevox.apps.agent import models


def too_large(*_):
    raise MemoryError


@pytest.mark.parametrize("content", [b"", b"rubbish" * 9, MAGIC, MAGIC + b"\xff" * 999])
def test_a_damaged_encoder_is_told_and_done_without(content, tmp_path, monkeypatch, caplog):
    file = tmp_path / "encoder.bin"
    file.write_bytes(content)
    monkeypatch.setattr(models, "locate", lambda _: file)

    assert models.open_decider() is None
    assert "encoder_missing" in caplog.text


def test_an_encoder_that_is_too_large_for_the_machine_is_told_and_done_without(
    tmp_path, monkeypatch, caplog
):
    monkeypatch.setattr(models, "locate", lambda _: tmp_path)
    monkeypatch.setattr(Encoder, "__init__", too_large)

    assert models.open_decider() is None
    assert "MemoryError" in caplog.text
