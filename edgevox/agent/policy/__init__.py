"""The policy: permitted requests by way, and limits of motion, read from one YAML file.

`file` is its format and `limits` its limits; `policy` judges by them. `guard` is the entry for all
callers: it holds the policy in force, reads the file again when it has changed, and counts
refusals. `explain` puts a policy into words, `status` reports it. Imports core, and of the agent
only skills and texts.
"""

from edgevox.agent.policy.file import Denied, NeedsConfirmation, PolicyFile, Rule, Verdict
from edgevox.agent.policy.guard import CheckedCall, Guard
from edgevox.agent.policy.limits import PolicyContext
from edgevox.agent.policy.policy import Policy, load_policy

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
