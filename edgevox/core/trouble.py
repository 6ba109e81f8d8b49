"""Trouble: what something that keeps trying says while it cannot do its work."""

from typing import Protocol, runtime_checkable


@runtime_checkable
class TellsTrouble(Protocol):
    """Knows why it cannot do its work now. It goes on trying by itself."""

    @property
    def trouble(self) -> str:
        """The reason in a few words; empty if all is well. From any thread."""


def trouble_of(thing: object) -> str:
    """What it says is wrong; empty for what cannot say it."""
    return thing.trouble if isinstance(thing, TellsTrouble) else ""
