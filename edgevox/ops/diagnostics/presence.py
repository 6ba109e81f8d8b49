"""The component `presence`: whether this agent is alone on its namespace."""

from dataclasses import dataclass

from edgevox.ops.diagnostics.component import Component, Finding, Level, component


@dataclass(frozen=True, slots=True)
class Sharing:
    """Who shares a namespace: the agent's own id there, the `others` in words, and whether it
    `yields`, which is to refuse to move because one of them is in charge.
    """

    namespace: str = ""
    id: str = ""
    others: tuple[str, ...] = ()
    yields: bool = False


def presence(seen: Sharing) -> Component:
    """Another agent is a warning; to refuse to move for its sake is an error."""
    found = []
    if seen.others:
        found.append(Finding(Level.WARN, f"also on {seen.namespace}: {', '.join(seen.others)}"))
    if seen.yields:
        text = "refuses to move while another agent is in charge, unless told to take over"
        found.append(Finding(Level.ERROR, text))
    return component(
        "presence",
        found,
        well=f"alone on {seen.namespace}",
        id=seen.id,
        others=len(seen.others),
        in_charge=not seen.yields,
    )
