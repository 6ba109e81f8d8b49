"""Where a `Robot` was found before it moved to `edgevox.robots.plugin`: older packages ask here."""

from edgevox.robots.plugin import GROUP, INSTRUCTIONS, Build, Robot

__all__ = ["GROUP", "INSTRUCTIONS", "Build", "Robot"]
