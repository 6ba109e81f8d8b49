"""What the robot may be asked for: by which way, within which limits; read from one YAML file.

`format` is the file, `policy` judges by it, `guard` is whom everybody asks: it holds the policy in
force, reads the file again when it has changed, and counts what is refused. Imports core, and of
the agent skills and reasons.
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
