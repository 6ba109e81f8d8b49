"""A model file is looked at before an engine is trusted with it."""

import contextlib
import struct
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from edgevox.agent.llm import factory, weights
from edgevox.agent.llm.language_model import ModelFailed


def string(text: str) -> bytes:
    return struct.pack("<Q", len(text)) + text.encode()


def whole_file() -> bytes:
    """A file with one value of each kind and one tensor of 100 x 100 weights."""
    values = [
        string("name") + struct.pack("<I", 8) + string("tiny"),
        string("layers") + struct.pack("<II", 4, 2),
        string("words") + struct.pack("<IIQ", 9, 8, 2) + string("a") + string("b"),
        string("sizes") + struct.pack("<IIQ", 9, 5, 3) + struct.pack("<3i", 1, 2, 3),
    ]
    tensor = string("weights") + struct.pack("<IQQIQ", 2, 100, 100, 0, 0)
    header = b"GGUF" + struct.pack("<IQQ", 3, 1, len(values)) + b"".join(values) + tensor
    return header + bytes(40_000)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "model.gguf"
    path.write_bytes(whole_file())
    return path


def test_a_whole_file_passes_with_its_size(path: Path) -> None:
    assert weights.check(path).size == path.stat().st_size


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelFailed, match=r"absent\.gguf: there is no such model file"):
        factory.load_model(tmp_path / "absent.gguf", "xllamacpp")


def test_a_file_of_another_kind_is_refused(path: Path) -> None:
    path.write_bytes(b"<html>not found</html>")

    with pytest.raises(ModelFailed, match="not a GGUF model"):
        weights.check(path)


def test_a_folder_is_not_a_model(tmp_path: Path) -> None:
    with pytest.raises(ModelFailed, match="cannot be read"):
        weights.check(tmp_path)


def test_a_file_whose_weights_are_cut_off_is_truncated(path: Path) -> None:
    path.write_bytes(whole_file()[:-39_990])

    with pytest.raises(ModelFailed, match="truncated"):
        weights.check(path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, len(whole_file()) - 40_001))
def test_a_header_cut_anywhere_is_refused(path: Path, length: int) -> None:
    path.write_bytes(whole_file()[:length])

    with pytest.raises(ModelFailed):
        weights.check(path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(4, 300), st.binary(min_size=1, max_size=8))
def test_a_damaged_header_is_refused_or_read_but_never_crashes(
    path: Path, place: int, noise: bytes
) -> None:
    content = bytearray(whole_file())
    content[place : place + len(noise)] = noise
    path.write_bytes(bytes(content))

    with contextlib.suppress(ModelFailed):
        assert weights.check(path).size == path.stat().st_size


def test_a_model_that_does_not_fit_into_memory_is_refused(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = weights.Memory(1 << 34, 1_000_000)
    monkeypatch.setattr(weights, "read_memory", lambda: there)

    with pytest.raises(ModelFailed, match="out of memory"):
        factory.load_model(path, "xllamacpp")


def test_without_an_engine_the_extra_to_install_is_named(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(factory.importlib.util, "find_spec", lambda name: None)

    with pytest.raises(ModelFailed, match=r"pip install .\.\[llm\]. in EdgeVox's"):
        factory.load_model(path)


def test_an_unknown_backend_is_refused_with_the_known_ones(path: Path) -> None:
    with pytest.raises(ModelFailed, match="expected auto, xllamacpp, llama-cpp-python"):
        factory.load_model(path, "ollama")  # type: ignore[arg-type]


def test_what_the_environment_says_about_waiting_is_respected(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("GOMP_SPINCOUNT", raising=False)
    monkeypatch.setenv("OMP_WAIT_POLICY", "ACTIVE")

    weights.spin_briefly()

    assert "GOMP_SPINCOUNT" not in weights.os.environ
