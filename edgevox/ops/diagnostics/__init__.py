"""Diagnostics: what each component says of itself. `component` is the vocabulary.

Every other module judges components from plain values, which `edgevox.apps.components` fetches.
"""

from edgevox.ops.diagnostics.component import (
    Component,
    Diagnostics,
    Finding,
    Level,
    Look,
    component,
)

__all__ = ["Component", "Diagnostics", "Finding", "Level", "Look", "component"]
