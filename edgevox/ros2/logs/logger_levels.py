"""Levels of loggers, by ROS 2's services and arguments: for its own loggers and for ours alike."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

import rclpy.logging
from rcl_interfaces.msg import LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.node import Node

from edgevox.core.log import ROOT
from edgevox.ops.logs import LEVELS, level_of, set_level

_OPTION = "--log-level"


class LoggerLevels:
    """Serves ``~/get_logger_levels`` and ``~/set_logger_levels``, instead of rclpy.

    A name stands for both Python's logger and ROS 2's. The node's own logger, as ``/rosout`` shows
    it, stands for all of EdgeVox.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._services = (
            node.create_service(GetLoggerLevels, "~/get_logger_levels", self._get),
            node.create_service(SetLoggerLevels, "~/set_logger_levels", self._set),
        )

    def close(self) -> None:
        """Serve them no more."""
        for service in self._services:
            self._node.destroy_service(service)

    def _get(
        self, request: GetLoggerLevels.Request, response: GetLoggerLevels.Response
    ) -> GetLoggerLevels.Response:
        response.levels = [LoggerLevel(name=n, level=self._level(n)) for n in request.names]
        return response

    def _set(
        self, request: SetLoggerLevels.Request, response: SetLoggerLevels.Response
    ) -> SetLoggerLevels.Response:
        response.results = [self._change(one.name, one.level) for one in request.levels]
        return response

    def _level(self, name: str) -> int:
        level = level_of(self._ours(name))
        if level:
            return level
        try:
            return int(rclpy.logging.get_logger_level(name))
        except RuntimeError:
            return LEVELS["unset"]

    def _change(self, name: str, level: int) -> SetLoggerLevelsResult:
        if level not in LEVELS.values():
            known = ", ".join(str(number) for number in sorted(set(LEVELS.values())))
            return SetLoggerLevelsResult(reason=f"level: got {level}, expected one of {known}")
        try:
            rclpy.logging.set_logger_level(name, level, detailed_error=True)
        except RuntimeError as error:
            return SetLoggerLevelsResult(reason=str(error))
        _set_ours(self._ours(name), level)
        return SetLoggerLevelsResult(successful=True)

    def _ours(self, name: str) -> str:
        """The name of Python's logger."""
        node = self._node.get_logger().name
        of_node = name == node or name.startswith(f"{node}.")
        return ROOT + name[len(node) :] if of_node else name


def apply_log_levels(ros_args: Sequence[str]) -> None:
    """Apply ROS 2's ``--log-level`` also to EdgeVox's loggers. Raises nothing: rcl checks."""
    for name, level in _asked(ros_args):
        if level in LEVELS:
            _set_ours(name, LEVELS[level])


def _set_ours(name: str, level: int) -> None:
    """Above all loggers is none to follow: there, unset is what it is for ROS 2."""
    set_level(name, level if name or level else LEVELS["info"])


def _asked(ros_args: Sequence[str]) -> Iterable[tuple[str, str]]:
    for option, value in pairwise(ros_args):
        if option == _OPTION:
            name, assigned, level = value.rpartition(":=")
            yield (name if assigned else "", level.lower())
