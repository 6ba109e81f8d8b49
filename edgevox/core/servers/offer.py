"""Which of a server's models to ask for, from its list (``/v1/models`` of the OpenAI protocol)."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from edgevox.core.servers.address import Address
from edgevox.core.servers.errors import Unusable

ModelKind = Literal["chat", "stt", "tts", "other"]

_TOLD: Mapping[str, ModelKind] = {
    "llm": "chat",
    "vlm": "chat",
    "chat": "chat",
    "text-generation": "chat",
    "image-text-to-text": "chat",
    "stt": "stt",
    "asr": "stt",
    "automatic-speech-recognition": "stt",
    "tts": "tts",
    "text-to-speech": "tts",
    "embedding": "other",
    "embeddings": "other",
    "feature-extraction": "other",
    "rerank": "other",
    "reranker": "other",
    "image": "other",
    "voice-activity-detection": "other",
    "speaker-embedding": "other",
}
"""Values of the fields below, as Speaches, LM Studio, LocalAI and others write them."""
_FIELDS = ("task", "type", "model_type")
_NAMED: Mapping[ModelKind, tuple[str, ...]] = {
    "stt": (
        "whisper", "parakeet", "canary", "transcribe", "moonshine", "sensevoice", "-asr", "stt",
    ),
    "tts": ("tts", "kokoro", "piper", "voxcpm", "chatterbox", "orpheus", "bark", "xtts"),
    "other": (
        "embed", "rerank", "bge-", "e5-", "gte-", "minilm", "clip", "moderation", "flux", "sdxl",
        "stable-diffusion", "dall-e", "silero", "pyannote", "wespeaker",
    ),
}  # fmt: skip
"""Parts of names that tell what a model does. All others may chat."""


def kind_of(entry: Mapping[str, Any]) -> ModelKind:
    """What a listed model does: as the server says, else as its name does."""
    for field in _FIELDS:
        if known := _TOLD.get(str(entry.get(field, "")).casefold()):
            return known
    name = str(entry.get("id", "")).casefold()
    for kind, parts in _NAMED.items():
        if any(part in name for part in parts):
            return kind
    return "chat"


def listed(reply: Any, address: Address) -> Sequence[Mapping[str, Any]]:
    """The models of a server's list. Raises `Unusable` if it is none."""
    try:
        found = [one for one in reply["data"] if str(one["id"])]
    except (KeyError, TypeError):
        found = []
    if not found:
        raise Unusable(f"{address.host} does not say which models it has")
    return found


def first_that(kind: ModelKind, reply: Any, address: Address) -> Mapping[str, Any]:
    """The first listed model of this kind.

    Raises `Unusable` if there is none, with the setting that names one.
    """
    found = listed(reply, address)
    for one in found:
        if kind_of(one) == kind:
            return one
    names = ", ".join(str(one["id"]) for one in found)[:200]
    does = {"chat": "chats", "stt": "transcribes", "tts": "speaks"}.get(kind, "fits")
    raise Unusable(
        f"{address.host} lists no model that {does}, only {names};"
        f" set {address.setting}_model if one does"
    )
