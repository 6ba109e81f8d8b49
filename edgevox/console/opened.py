"""The address at which a console is open to the network: a file beside the paired browsers.

A command beside the running robot writes it, and the console then listens there too, without a
restart and also after one. So a person opens a console that nothing but this machine reached.
"""

import json
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path

from edgevox.console.certificates import is_private_address, own_addresses
from edgevox.core.files.state_files import StateFiles, write_atomically
from edgevox.core.files.validation import read_json_object


@dataclass(frozen=True, slots=True)
class _Opened:
    address: str


class Opened:
    """The address, or none. Raises `OSError` where the folder can be neither read nor written."""

    def __init__(self, folder: Path, state: StateFiles | None = None) -> None:
        self._file = folder / "opened.json"
        self._state = state or StateFiles()

    def address(self) -> str:
        """The address on which the console shall listen too; empty for none."""
        found = self._state.read(self._file, _opened)
        return found.address if found else ""

    def open(self, address: str) -> None:
        """Open it at this address of the machine."""
        self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_atomically(self._file, json.dumps({"address": address}))

    def close(self) -> bool:
        """Close it; whether it was open."""
        try:
            self._file.unlink()
        except FileNotFoundError:
            return False
        return True


def network_address() -> str:
    """The private IPv4 address by which this machine reaches its network; empty if it has none."""
    found = (one for one in own_addresses() if not ip_address(one).is_loopback)
    return next((one for one in found if ":" not in one), "")


def _opened(text: str) -> _Opened:
    """Raises `ValueError`, `KeyError` or `InvalidValue` for a text that holds no private one."""
    address = str(read_json_object(text, "opened")["address"])
    if not is_private_address(ip_address(address)):
        raise ValueError("expected a private address")
    return _Opened(address)
