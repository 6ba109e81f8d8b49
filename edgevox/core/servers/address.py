"""The address of a server: where it is, the key that opens it, and which model to ask for."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

from pydantic import AfterValidator

from edgevox.core.files.user_file import regular
from edgevox.core.servers.errors import Unusable

_LONGEST_KEY = 4096
_HOST = r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]+)"
_HTTP = rf"https?://{_HOST}(:[0-9]{{1,5}})?(/[\w./~-]*)?"
_WYOMING = rf"(tcp|wyoming)://{_HOST}:[0-9]{{1,5}}/?"
_SERVICES = re.compile(
    r"(?<=.)/(chat/completions|completions|models|audio/transcriptions|audio/speech)/?$"
)
"""What people copy with the address: the service that EdgeVox adds by itself."""


def _valid(form: str, expected: str) -> Callable[[str], str]:
    def check(url: str) -> str:
        """The address without blanks and without a service at its end, its scheme in small."""
        scheme, colon, rest = url.strip().partition("://")
        plain = _SERVICES.sub("", f"{scheme.lower()}{colon}{rest}")
        if plain and not re.fullmatch(form, plain):
            raise ValueError(expected)
        return plain

    return check


Endpoint = Annotated[
    str,
    AfterValidator(
        _valid(
            _HTTP,
            "the address of a server such as http://llm.example:8080; its key stands in"
            " llm_endpoint_key_file",
        )
    ),
]
"""The address of a server, without a key; empty for none."""
SpeechEndpoint = Annotated[
    str,
    AfterValidator(
        _valid(
            f"{_HTTP}|{_WYOMING}",
            "the address of a server such as http://speech.example:8000 (OpenAI audio API) or"
            " tcp://speech.example:10300 (Wyoming); its key stands in a file of its own",
        )
    ),
]
"""The address of a server that hears or speaks, by HTTP or Wyoming; empty for none."""


@dataclass(frozen=True, slots=True)
class Address:
    """One server. `url` is its root or its ``/v1``; an empty `model` is the first that fits.

    `timeout_s` is the longest wait for the beginning of an answer, attempts and pauses included,
    and for each later piece. The key is read from its file for every request, so that it can be
    renewed. `setting` is the setting that names the server.
    """

    url: str
    model: str = ""
    timeout_s: float = 10.0
    key_file: Path | None = None
    setting: str = "llm_endpoint"

    @property
    def host(self) -> str:
        """What to call it in a log."""
        return urlsplit(self.url).netloc

    @property
    def encrypted(self) -> bool:
        """Whether nobody between can read what is sent."""
        return self.url.startswith("https://")

    def route(self, name: str) -> str:
        """The address of one of its services."""
        root = self.url.rstrip("/")
        return f"{root}/{name}" if root.endswith("/v1") else f"{root}/v1/{name}"

    def headers(self) -> dict[str, str]:
        """What goes with every request. Raises `Unusable` if there is no key to be had."""
        # What is compressed could be small on the wire and fill the memory.
        plain = {"Accept-Encoding": "identity", "Connection": "close"}
        if self.key_file is None:
            return plain
        field = f"{self.setting}_key_file"
        try:
            with open(self.key_file, encoding="ascii", opener=regular) as file:
                key = file.read(_LONGEST_KEY + 1).strip()
        except (OSError, UnicodeDecodeError):
            raise Unusable(f"{field}: {self.key_file} cannot be read") from None
        if not 0 < len(key) <= _LONGEST_KEY or not key.isprintable() or " " in key:
            raise Unusable(f"{field}: {self.key_file} does not hold one key")
        return plain | {"Authorization": f"Bearer {key}"}


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
