"""The former home of `Robot`, now in `edgevox.robots.plugin`: kept for older packages."""

from edgevox.robots.plugin import GROUP, INSTRUCTIONS, Build, Robot

__all__ = ["GROUP", "INSTRUCTIONS", "Build", "Robot"]
