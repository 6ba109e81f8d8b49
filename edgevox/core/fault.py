"""A fault: what something that keeps trying says while it cannot do its work."""

from typing import Protocol, runtime_checkable


@runtime_checkable
class ReportsFault(Protocol):
    """Knows why it cannot do its work now. It goes on trying by itself."""

    @property
    def fault(self) -> str:
        """The reason in a few words; empty if all is well. From any thread."""


def fault_of(thing: object) -> str:
    """What it says is wrong; empty for what cannot say it."""
    return thing.fault if isinstance(thing, ReportsFault) else ""
