"""EdgeVox: an offline voice agent for robots, visible and steerable over ROS 2."""

__version__: str


def __getattr__(name: str) -> str:
    """``__version__``, which costs a question to git in a checkout, for those who ask."""
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from edgevox.core.version import version

    return version()
