"""What all parts of a policy file have in common."""

from pydantic import BaseModel, ConfigDict


class PolicyPart(BaseModel):
    """A mapping of the file: no key that nobody knows, no number that is none."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
