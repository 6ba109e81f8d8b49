"""What an enclave was made for, kept beside it: what `renew` makes its permissions of again."""

import json
from dataclasses import asdict, dataclass, replace

from pydantic import TypeAdapter

from edgevox.security.roles import EnclaveRole, Graph


@dataclass(frozen=True, slots=True)
class Purpose:
    """A role with a robot, on one domain, for so many days each time."""

    role: EnclaveRole
    graph: Graph
    domain: int
    days: int

    def lasting(self, days: int) -> "Purpose":
        """The same for so many days."""
        return replace(self, days=days)

    def written(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self), default=str, indent=2) + "\n"

    @classmethod
    def read(cls, text: str) -> "Purpose":
        """From what was `written`. Raises `ValueError` for what was not."""
        return TypeAdapter(cls).validate_json(text)
