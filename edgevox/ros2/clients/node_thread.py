"""Work that is done on the thread that spins a node, for who waits on another one.

There nothing else happens to the node meanwhile: rclpy's action clients and a node's lists of what
it has are not made for several threads.
"""

from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TypeVar

from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

T = TypeVar("T")

NODE_S = 5.0
"""So long the node's thread may be busy with something else."""


class NodeBusy(Exception):
    """The node's thread did not come to it."""


def on_node_thread(node: Node, work: Callable[[Node], T], timeout_s: float = NODE_S) -> T:
    """What this returns, or raises, on the thread that spins the node. It must not wait there.

    Raises `NodeBusy` if nothing has begun it by then; it is not begun later.
    """
    done: Future[T] = Future()
    try:
        if node.executor is None:
            raise NodeBusy
        node.executor.create_task(_do, work, node, done)
    except InvalidHandle:  # it is shut down
        raise NodeBusy from None
    wait([done], timeout_s)
    if not done.done() and done.cancel():
        raise NodeBusy
    return done.result()


def _do(work: Callable[[Node], T], node: Node, done: "Future[T]") -> None:
    if not done.set_running_or_notify_cancel():
        return
    try:
        done.set_result(work(node))
    except BaseException as error:  # noqa: BLE001 - whoever waits for it gets it
        done.set_exception(error)
