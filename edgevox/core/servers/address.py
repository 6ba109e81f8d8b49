"""The address of a server: where it is, what to ask it for, and the key that opens it."""

from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from edgevox.core.files.user_file import regular
from edgevox.core.servers.errors import Unusable

_LONGEST_KEY = 4096


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
