"""The choice of an agent's language model: the one on board, a shared one on a server, or none.

Also here: the encoder that judges whether a sentence is an order, if it was fetched, and the
phonemes of espeak-ng, if it is installed.
"""

import struct
from pathlib import Path

from edgevox.agent.llm.language_model import AbsentModel, LanguageModel
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.encoder import ENCODER
from edgevox.agent.nlu.hearing.sounds import Phonemes
from edgevox.apps.streams import show
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import get_logger
from edgevox.core.settings import NO_LLM, Settings
from edgevox.models import locate

log = get_logger(__name__)


_UNUSABLE = (EdgeVoxError, MemoryError, OSError, ValueError, LookupError, struct.error)
"""A file that is missing, is none of its kind, is cut short or damaged, or is too much here."""


def open_decider() -> Decider | None:
    """None where the encoder cannot be had: then only what templates know is done."""
    from edgevox.agent.nlu.encoder import Encoder, read_head

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


def find_weights(settings: Settings) -> Path | None:
    """The file of the model on board; None where there is to be none. Raises `EdgeVoxError`."""
    if settings.llm == NO_LLM:
        return None
    path = Path(settings.llm)
    return path if path.suffix == ".gguf" else locate(settings.llm)


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
