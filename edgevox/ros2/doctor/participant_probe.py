"""A probe that joins a DDS enclave. Runs in its own process, with that enclave's environment."""

from typing import Any

_NO_PARTICIPANT = "create participant"
"""Part of rmw's message if the enclave is at fault, and not the node's name."""


def participant_probe() -> dict[str, Any]:
    """Try to create a participant in the environment's enclave, and leave at once.

    Only the middleware can check who signed the governance and the permissions.
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
