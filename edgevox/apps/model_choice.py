"""Which language model an agent has: the one on board, a shared one on a server, or none."""

from pathlib import Path

from edgevox.agent.llm.absent import AbsentModel
from edgevox.agent.llm.language_model import LanguageModel
from edgevox.apps.streams import show
from edgevox.core.settings import NO_LLM, Settings
from edgevox.models import locate


def find_weights(settings: Settings) -> Path | None:
    """The file of the model on board; None where there is to be none. Raises `EdgeVoxError`."""
    if settings.llm == NO_LLM:
        return None
    path = Path(settings.llm)
    return path if path.suffix == ".gguf" else locate(settings.llm)


def open_model(settings: Settings, weights: Path | None) -> LanguageModel | None:
    """What thinks. Raises `EdgeVoxError` for weights that cannot be loaded.

    With a server the model on board is loaded too: whoever falls back must not wait for it, and the
    memory that it takes shows on the first day, not on the first bad one. `llm` none saves it.
    """
    return _beside_server(settings, _load(settings, weights) if weights else None)


def open_without(settings: Settings, fault: str) -> LanguageModel:
    """What thinks where the model on board cannot be had: a server alone, or nothing at all."""
    absent = AbsentModel(fault, context_tokens=settings.llm_context)
    return _beside_server(settings, None) or absent


def _beside_server(settings: Settings, on_board: LanguageModel | None) -> LanguageModel | None:
    if not settings.llm_endpoint:
        return on_board
    from edgevox.agent.llm.endpoint import Address, EndpointModel, FallbackModel

    server = Address(
        settings.llm_endpoint,
        settings.llm_endpoint_model,
        settings.llm_endpoint_timeout,
        settings.llm_endpoint_key_file,
        settings.llm_endpoint_grammar,
    )
    return FallbackModel(EndpointModel(server, context_tokens=settings.llm_context), on_board)


def _load(settings: Settings, weights: Path) -> LanguageModel:
    from edgevox.agent.llm.factory import load_model

    show(f"loading {weights.name} ...")
    return load_model(
        weights,
        backend=settings.llm_backend,
        context_tokens=settings.llm_context,
        threads=settings.llm_threads or None,
    )
