"""The factory of language models, for whichever engine is installed.

It reads the processor's features from ``/proc/cpuinfo``, because psutil does not tell them.
"""

import importlib.util
import platform
from pathlib import Path

from edgevox.agent.llm import weights
from edgevox.agent.llm.language_model import CONTEXT_TOKENS, LanguageModel, ModelFailed
from edgevox.agent.llm.llama_cpp_model import LlamaCppModel
from edgevox.agent.llm.xllamacpp_model import XllamacppModel
from edgevox.core.errors import install_extra
from edgevox.core.settings import LlmBackend

XLLAMACPP_NEEDS = frozenset({"avx2", "fma", "f16c", "bmi2"})
"""Its wheel for x86-64 is built for these; without them the process would end without a word."""


def missing_features(needed: frozenset[str], cpuinfo: str | None = None) -> frozenset[str]:
    """Needed features that an x86-64 processor lacks; empty if that is unknown.

    `cpuinfo` is the text of ``/proc/cpuinfo``.
    """
    if cpuinfo is None:
        if platform.machine() != "x86_64":
            return frozenset()
        try:
            cpuinfo = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return frozenset()
    for line in cpuinfo.splitlines():
        name, _, flags = line.partition(":")
        if name.strip() == "flags":
            return needed - set(flags.split())
    return frozenset()


_ENGINES: dict[str, tuple[str, type[XllamacppModel] | type[LlamaCppModel]]] = {
    "xllamacpp": ("xllamacpp", XllamacppModel),
    "llama-cpp-python": ("llama_cpp", LlamaCppModel),
}
"""Name of each backend to the module it needs and the class that drives it, best first."""


def load_model(
    path: Path,
    backend: LlmBackend = "auto",
    *,
    context_tokens: int = CONTEXT_TOKENS,
    threads: int | None = None,
) -> LanguageModel:
    """A loaded model; `threads` None means as many as suit this machine. Raises `ModelFailed`."""
    chosen = _choose(backend)
    _check_memory(path, weights.check(path), context_tokens)
    engine = _ENGINES[chosen][1]
    return engine(path, context_tokens=context_tokens, threads=threads)


def _choose(backend: LlmBackend) -> str:
    candidates = tuple(_ENGINES) if backend == "auto" else (backend,)
    lacks = missing_features(XLLAMACPP_NEEDS) if "xllamacpp" in candidates else frozenset()
    if lacks:
        candidates = tuple(name for name in candidates if name != "xllamacpp")
    for name in candidates:
        if name not in _ENGINES:
            raise ModelFailed(f"backend: got {name!r}, expected auto, {', '.join(_ENGINES)}")
        if importlib.util.find_spec(_ENGINES[name][0]) is not None:
            return name
    if lacks:
        raise ModelFailed(
            f"xllamacpp: this processor lacks {', '.join(sorted(lacks))}; use llama-cpp-python"
            f" ({install_extra('llama-cpp')}) or a shared model (llm_endpoint)"
        )
    raise ModelFailed(
        f"no engine for language models ({' or '.join(candidates)}) is installed: "
        f"{install_extra('llm')} for xllamacpp, '.[llama-cpp]' for llama-cpp-python"
    )


def _check_memory(path: Path, model: weights.Weights, context_tokens: int) -> None:
    """Refuse what cannot fit: the kernel would otherwise kill the robot's process halfway."""
    needed, there = (
        weights.needed_bytes(model, context_tokens),
        weights.read_memory(),
    )
    if there and needed > there.free:
        raise ModelFailed(
            f"{path}: out of memory: a context of {context_tokens} tokens needs about"
            f" {needed / 1e9:.1f} GB, {there.free / 1e9:.1f} GB are free; choose a smaller model"
            " (llm), a smaller context (llm_context) or a server (llm_endpoint)"
        )
