"""Whether the middleware takes an enclave. Runs in a process of its own, with its environment."""

from typing import Any

_NO_PARTICIPANT = "create participant"
"""In what rmw says where the enclave is at fault, and not what the node is called."""


def participant_probe() -> dict[str, Any]:
    """Whether a participant is made in the environment's enclave; it is left at once.

    The middleware checks what nobody else here can: who signed the governance and the permissions.
    """
    import rclpy
    from rclpy.context import Context

    context = Context()
    try:
        context.init()
        rclpy.create_node("edgevox_enclave_check", context=context).destroy_node()
    except Exception as failed:  # noqa: BLE001 - rclpy has no base class for what it raises
        return {"taken": _NO_PARTICIPANT not in str(failed)}
    finally:
        context.try_shutdown()
    return {"taken": True}
