"""The policy: permitted requests by way, and limits of motion, read from one YAML file.

`policy` is its format and judges by it, `limits` are its limits of motion. `guard` is the entry for
all callers: it holds the policy in force, reads the file again when it has changed, counts
refusals, and reports all of this in words. Imports core, and of the agent only skills and texts.
"""

from edgevox.agent.policy.guard import CheckedCall, Guard
from edgevox.agent.policy.limits import PolicyContext
from edgevox.agent.policy.policy import (
    Denied,
    NeedsConfirmation,
    Policy,
    PolicyFile,
    Rule,
    Verdict,
    load_policy,
)

__all__ = [
    "CheckedCall",
    "Denied",
    "Guard",
    "NeedsConfirmation",
    "Policy",
    "PolicyContext",
    "PolicyFile",
    "Rule",
    "Verdict",
    "load_policy",
]
