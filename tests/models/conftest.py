"""The models that the tests share, as `edgevox-models` keeps them."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from steady_piper import steady_piper
from voice_rig import VoiceRig, shared_decider

from edgevox.agent.llm import weights
from edgevox.agent.llm.factory import load_model
from edgevox.agent.llm.language_model import LanguageModel
from edgevox.agent.nlu.decider import Decider
from edgevox.models import locate


@pytest.fixture(scope="session", autouse=True)
def _steady() -> Iterator[None]:
    with steady_piper():
        yield


@pytest.fixture(scope="session")
def threads(worker: tuple[int, int]) -> int:
    """For an engine: what one worker may use of the cores.

    More would take as much from the other workers as they give, and wait for each other besides:
    beside a busy core, two threads are slower than one (`edgevox/agent/llm/weights.py`).
    """
    _, workers = worker
    return max(1, weights.default_threads() // workers)


@pytest.fixture(scope="module")
def small(threads: int) -> Iterator[LanguageModel]:
    """The model of the set `small`, which reads the apartment's instructions for 20 s of a core."""
    model = load_model(locate("qwen2.5-coder-0.5b-instruct"), threads=threads)
    yield model
    model.close()


@pytest.fixture(scope="session")
def tiny_path() -> Path:
    return locate("smollm2-135m-instruct")


@pytest.fixture(scope="module")
def tiny(tiny_path: Path, threads: int) -> Iterator[LanguageModel]:
    """The smallest model there is: for what is true of any."""
    model = load_model(tiny_path, threads=threads)
    yield model
    model.close()


@pytest.fixture(scope="session")
def decider() -> Decider:
    """One for all: its encoder takes a quarter of a GB, and a second to read."""
    return shared_decider()


@pytest.fixture(scope="module")
def context_tokens() -> int:
    """How much `model` reads at most; a file may say otherwise."""
    return 512


@pytest.fixture(scope="module", params=["xllamacpp", "llama-cpp-python"])
def model(
    request: pytest.FixtureRequest, tiny_path: Path, threads: int, context_tokens: int
) -> Iterator[LanguageModel]:
    loaded = load_model(tiny_path, request.param, context_tokens=context_tokens, threads=threads)
    yield loaded
    loaded.close()


@pytest.fixture(scope="module")
def home_with() -> dict[str, Any]:
    """What the apartment of a file's tests has besides; a file may say otherwise."""
    return {}


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory, home_with: dict[str, Any]) -> Iterator[VoiceRig]:
    """The agent in the apartment, for all tests of a file."""
    with pytest.MonkeyPatch.context() as patch:
        answers = tmp_path_factory.mktemp("answers") / "answers.wav"
        with VoiceRig(patch, answers, robot="robot-apartment", **home_with) as rig:
            yield rig


@pytest.fixture
def rig(home: VoiceRig) -> VoiceRig:
    """The same, at rest, with nothing noted yet."""
    home.forget()
    return home
