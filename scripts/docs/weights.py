"""The tables of docs/models.md, from the manifest."""

from docs.markdown import code, table
from docs.told import told
from edgevox.models.manifest import builtin_manifest


def sets() -> str:
    """The sets of models, with their sizes."""
    manifest = builtin_manifest()
    rows = (
        (
            f"`{name}`",
            entry["what"],
            f"{sum(model.size for model in manifest.select([name])) / 1e6:.0f} MB",
            entry["needs"],
        )
        for name, entry in told(manifest.sets, "sets").items()
    )
    return table(("set", "contents", "size", "needs"), rows, right={"size"})


def not_commercial() -> str:
    """The models whose licences forbid commercial use."""
    manifest = builtin_manifest()
    rows = (
        (
            f"`{model.id}`",
            model.title,
            code(model.licences),
            code(name for name, members in manifest.sets.items() if model.id in members),
        )
        for model in manifest.models.values()
        if not manifest.allows_commercial_use(model)
    )
    return table(("not for commercial use", "what it is", "licence", "in the set"), rows)
