"""The hint how to install an optional part of EdgeVox.

From EdgeVox's own folder, and never by a name that a package index looks up: there the name of this
import package belongs to somebody else.
"""


def install_extra(extra: str) -> str:
    """The command that installs an extra, and the folder to run it in."""
    return f"pip install '.[{extra}]' in EdgeVox's folder"
