"""A thread that runs an executor's callbacks, and ends before the executor is shut down.

`Executor.shutdown` frees what a callback on another thread may be about to use: seen in rclpy 7.1,
once in some hundred ends of a busy node, as `InvalidHandle`.

No wait is for ever: seen with Fast DDS 2.14 and glibc 2.36, a thread slept on in `rcl_wait` after a
message and a signal had come. A lost wake-up costs a second at most.
"""

import threading

from rclpy.executors import Executor

LONGEST_WAIT_S = 1.0


def spin_until(ended: threading.Event, executor: Executor) -> None:
    """Run callbacks until it is set. Raises what they raise, or `ExternalShutdownException`."""
    while not ended.is_set():
        executor.spin_once(timeout_sec=LONGEST_WAIT_S)


def end_spin(ended: threading.Event, executor: Executor, thread: threading.Thread) -> None:
    """End the thread that spins, and then the executor. Not to be called on that thread."""
    ended.set()
    executor.create_task(_nothing)  # `wake` alone leaves `spin_once` waiting for a callback
    if thread.is_alive():
        thread.join()
    executor.shutdown()


def _nothing() -> None:
    """A callback for a thread that has nothing else to do."""
