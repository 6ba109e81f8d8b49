"""Model files: their licences and sources, download, verification and lookup.

Imports core only. `locate` is what the rest of EdgeVox needs; `edgevox-models` is its terminal.
"""

from edgevox.models.fetch import fetch
from edgevox.models.manifest import UnknownModel
from edgevox.models.store import FetchFailed, ModelMissing, Store, StoreNotWritable, locate

__all__ = [
    "FetchFailed",
    "ModelMissing",
    "Store",
    "StoreNotWritable",
    "UnknownModel",
    "fetch",
    "locate",
]
