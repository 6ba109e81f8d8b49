"""One way to get a language model, whichever engine is installed."""

import importlib.util
import resource
from pathlib import Path
from typing import Literal

from edgevox.agent.llm import gguf
from edgevox.agent.llm.base import CONTEXT_TOKENS, LanguageModel, ModelFailed
from edgevox.agent.llm.cpu import XLLAMACPP_NEEDS, missing_features
from edgevox.agent.llm.llama_cpp_model import LlamaCppModel
from edgevox.agent.llm.xllamacpp_model import XllamacppModel
from edgevox.core.cgroup import memory_left
from edgevox.core.extras import install_extra

Backend = Literal["auto", "xllamacpp", "llama-cpp-python"]

_ENGINES: dict[str, tuple[str, type[XllamacppModel] | type[LlamaCppModel]]] = {
    "xllamacpp": ("xllamacpp", XllamacppModel),
    "llama-cpp-python": ("llama_cpp", LlamaCppModel),
}
"""Name of each backend to the module it needs and the class that drives it, best first."""

_BUFFERS_BYTES = 160 << 20
"""Beside the weights and the cache of the context: the buffers of the engine."""
_NOBODY_NEEDS_MORE = 1 << 60


def load_model(
    path: Path,
    backend: Backend = "auto",
    *,
    context_tokens: int = CONTEXT_TOKENS,
    threads: int | None = None,
) -> LanguageModel:
    """A loaded model; `threads` None means as many as suit this machine. Raises `ModelFailed`."""
    chosen = _choose(backend)
    _check_memory(path, gguf.check(path), context_tokens)
    engine = _ENGINES[chosen][1]
    return engine(path, context_tokens=context_tokens, threads=threads)


def _choose(backend: Backend) -> str:
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


def _check_memory(path: Path, weights: gguf.Weights, context_tokens: int) -> None:
    """Refuse what cannot fit: the kernel would otherwise kill the robot's process halfway."""
    needed = weights.size + context_tokens * weights.bytes_per_token + _BUFFERS_BYTES
    free = _available_bytes()
    if free is not None and needed > free:
        raise ModelFailed(
            f"{path}: out of memory: a context of {context_tokens} tokens needs about"
            f" {needed / 1e9:.1f} GB, {free / 1e9:.1f} GB are free; choose a smaller model (llm),"
            " a smaller context (llm_context) or a server (llm_endpoint)"
        )


def _available_bytes() -> int | None:
    """What the kernel can give, and the limits of container and process allow; None if unknown."""
    given = (_free_bytes(), memory_left(), _address_space_left())
    return min((one for one in given if one is not None), default=None)


def _address_space_left() -> int | None:
    """What `ulimit -v` allows; None where there is no such limit."""
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if not 0 <= most < _NOBODY_NEEDS_MORE:
        return None
    taken = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    return max(0, most - taken * resource.getpagesize())


def _free_bytes() -> int | None:
    """What the machine has without swapping."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    for line in lines:
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) * 1024
    return None
