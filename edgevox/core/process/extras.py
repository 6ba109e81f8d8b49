"""How to get a part of EdgeVox that is not installed.

From EdgeVox's own folder, and never by a name that a package index looks up: there the name of this
import package belongs to somebody else.
"""


def install_extra(extra: str) -> str:
    """The command that installs an extra, and where to type it."""
    return f"pip install '.[{extra}]' in EdgeVox's folder"
