"""The levels, by the names that ROS 2 uses for them and for loggers; changed while all runs.

A logger is called after its module: `edgevox` is all of EdgeVox, `edgevox.voice` speech in
and out; a library has its own name. The empty name is above all, and begins with the setting
`log_level`. A level of 0 means: as the logger above.
"""

import logging
from collections.abc import Mapping

LEVELS: Mapping[str, int] = {
    "unset": logging.NOTSET,
    "debug": logging.DEBUG,
    "info": logging.INFO,
    "warn": logging.WARNING,
    "warning": logging.WARNING,
    "error": logging.ERROR,
    "fatal": logging.CRITICAL,
}
"""The numbers are the same for Python and for ROS 2."""


def level_of(name: str) -> int:
    """The level that was set for this logger; 0 if none was. Makes no logger."""
    logger = logging.getLogger() if not name else logging.Logger.manager.loggerDict.get(name)
    return logger.level if isinstance(logger, logging.Logger) else logging.NOTSET


def set_level(name: str, level: int) -> None:
    """Show this logger's lines of that level and above, and those of the loggers below it."""
    logging.getLogger(name or None).setLevel(level)
