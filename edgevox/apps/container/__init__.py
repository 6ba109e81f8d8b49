"""The container's first step: checks the environment variables, then starts the program.

`environment.toml` is the table of the variables; docs, compose files and chart are held to it.
Imports all of edgevox; nothing but the entrypoint imports it.
"""

from edgevox.apps.container.environment import ENVIRONMENT, Variable, prepared

__all__ = ["ENVIRONMENT", "Variable", "prepared"]
