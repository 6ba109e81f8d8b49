"""Queries as services: a Trigger for each, whose message is the JSON that `info` carries."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rclpy.node import Node
from std_srvs.srv import Trigger

from edgevox.ros2.contract import QUERIES, Queries, answer_json


class QueryServices:
    """Serves the contract's queries on a node."""

    def __init__(self, node: Node, queries: Queries) -> None:
        for name in QUERIES:
            node.create_service(Trigger, name, partial(_answer, name, queries[name]))

    def close(self) -> None:
        """Nothing of its own; the services end with their node."""


def _answer(
    name: str,
    ask: Callable[[], Mapping[str, Any]],
    _request: Trigger.Request,
    response: Trigger.Response,
) -> Trigger.Response:
    response.success = True
    response.message = answer_json(name, ask())
    return response
