"""Packages from a folder that an operator names: robots and skills, without an installation.

Nothing is fetched, built or installed. Imports only core; the programs import it.
"""

from edgevox.apps.plugins.bring_plugins import Plugins, bring_plugins, plugins_folder

__all__ = ["Plugins", "bring_plugins", "plugins_folder"]
