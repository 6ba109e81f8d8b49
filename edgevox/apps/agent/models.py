"""The choice of an agent's language model: the one on board, a shared one on a server, or none.

Also here: the encoder that judges whether a sentence is an order, if it was fetched, and the
phonemes of espeak-ng, if it is installed.
"""

import struct
from pathlib import Path

from edgevox.agent.llm.language_model import AbsentModel, LanguageModel
from edgevox.agent.llm.weights import read_memory
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder import ENCODER
from edgevox.agent.nlu.hearing.sounds import Phonemes
from edgevox.apps.streams import show
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import get_logger
from edgevox.core.settings import AUTO_LLM, NO_LLM, Settings
from edgevox.models import ModelMissing, locate

log = get_logger(__name__)


SMALLER, LARGER = "qwen2.5-coder-0.5b-instruct", "qwen2.5-coder-1.5b-instruct"
LARGER_NEEDS_BYTES = 6e9
"""Free memory from which on the larger one leaves enough to the rest of the robot."""

_UNUSABLE = (EdgeVoxError, MemoryError, OSError, ValueError, LookupError, struct.error)
"""A file that is missing, is none of its kind, is cut short or damaged, or is too much here."""


def open_decider() -> Decider | None:
    """None where the encoder cannot be had: then only what templates know is done."""
    from edgevox.agent.nlu.encoder import Encoder
    from edgevox.agent.nlu.head import read_head

    try:
        return Decider(Encoder(locate(ENCODER)), read_head())
    except _UNUSABLE as error:
        reason = str(error) or type(error).__name__
        log.error("encoder_missing", reason=reason)  # noqa: TRY400 - the reason says it all
        return None


def open_phonemes() -> Phonemes | None:
    """None where espeak-ng is no library here: then misheard commands are not understood."""
    try:
        from edgevox.voice.tts.espeak import espeak_library

        library = espeak_library()
    except (ImportError, OSError, EdgeVoxError) as error:
        log.info("phonemes_missing", reason=str(error))
        return None
    return lambda text, code: library.phonemes(text, LANGUAGES[code].voices[-1].key)


def chosen_llm(settings: Settings) -> str:
    """What `llm` names: an id of edgevox-models, a GGUF file, or `NO_LLM`."""
    if settings.llm != AUTO_LLM:
        return settings.llm
    memory = read_memory()
    try:
        if memory and memory.free >= LARGER_NEEDS_BYTES:
            locate(LARGER)
            return LARGER
    except ModelMissing:
        pass
    return SMALLER


def find_weights(settings: Settings) -> Path | None:
    """The file of the model on board; None where there is to be none. Raises `EdgeVoxError`."""
    chosen = chosen_llm(settings)
    if chosen == NO_LLM:
        return None
    path = Path(chosen)
    return path if path.suffix == ".gguf" else locate(chosen)


def open_model(settings: Settings, weights: Path | None) -> LanguageModel | None:
    """Open the language model. Raises `EdgeVoxError` for weights that cannot be loaded.

    With a server the model on board is loaded too: a fallback must not wait for it, and its memory
    use shows on the first day, not on the first bad one. `llm` none saves it.
    """
    return _beside_server(settings, _load(settings, weights) if weights else None)


def open_without(settings: Settings, fault: str) -> LanguageModel:
    """Open a substitute without the model on board: a server alone, or none at all."""
    absent = AbsentModel(fault, context_tokens=settings.llm_context)
    return _beside_server(settings, None) or absent


def _beside_server(settings: Settings, on_board: LanguageModel | None) -> LanguageModel | None:
    if not settings.llm_endpoint:
        return on_board
    from edgevox.agent.llm.remote_model import EndpointModel, FallbackModel
    from edgevox.core.servers.address import Address

    server = Address(
        settings.llm_endpoint,
        settings.llm_endpoint_model,
        settings.llm_endpoint_timeout,
        settings.llm_endpoint_key_file,
    )
    shared = EndpointModel(
        server, dialect=settings.llm_endpoint_grammar, context_tokens=settings.llm_context
    )
    return FallbackModel(shared, on_board)


def _load(settings: Settings, weights: Path) -> LanguageModel:
    from edgevox.agent.llm.factory import load_model

    show(f"loading {weights.name} ...")
    return load_model(
        weights,
        backend=settings.llm_backend,
        context_tokens=settings.llm_context,
        threads=settings.llm_threads or None,
    )
