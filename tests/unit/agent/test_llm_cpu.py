import pytest

from edgevox.agent.llm import factory
from edgevox.agent.llm.factory import XLLAMACPP_NEEDS, missing_features
from edgevox.agent.llm.language_model import ModelFailed

OLD = "processor\t: 0\nflags\t\t: fpu sse2 avx f16c\n"
NEW = "processor\t: 0\nflags\t\t: fpu avx avx2 fma f16c bmi1 bmi2\n"


def test_an_old_processor_is_told_by_what_it_lacks():
    assert missing_features(XLLAMACPP_NEEDS, OLD) == {"avx2", "fma", "bmi2"}
    assert missing_features(XLLAMACPP_NEEDS, NEW) == frozenset()
    assert missing_features(XLLAMACPP_NEEDS, "Features : neon\n") == frozenset()


def test_an_engine_that_would_die_on_this_processor_is_refused_with_what_to_do(
    monkeypatch, tmp_path
):
    monkeypatch.setattr(factory, "missing_features", lambda _: frozenset({"avx2"}))
    with pytest.raises(ModelFailed, match="lacks avx2; use llama-cpp-python"):
        factory.load_model(tmp_path / "any.gguf", "xllamacpp")
