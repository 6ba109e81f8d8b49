"""The models that the tests share, as `edgevox-models` keeps them."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from edgevox.agent.llm.base import LanguageModel
from edgevox.agent.llm.factory import load_model
from edgevox.models import locate

# The tests judge a model as the benchmark does.
sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))


@pytest.fixture(scope="session")
def tiny_path() -> Path:
    return locate("smollm2-135m-instruct")


@pytest.fixture(scope="module", params=["xllamacpp", "llama-cpp-python"])
def model(request: pytest.FixtureRequest, tiny_path: Path) -> Iterator[LanguageModel]:
    loaded = load_model(tiny_path, request.param, context_tokens=1024)
    yield loaded
    loaded.close()
