"""The reasons that robots give, by their codes: English ones stand where all other languages do."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources

from edgevox.core.reasons import Reason


def because(code: str, **values: str | Reason) -> Reason:
    """The reason of this code. Raises `KeyError` for one that `phrases/en.toml` does not have."""
    told = {name: str(value).rstrip(".") for name, value in values.items()}
    return Reason(_english()[code].format(**told), code, values)


@cache
def _english() -> Mapping[str, str]:
    file = resources.files("edgevox.agent.phrases").joinpath("en.toml")
    reasons: Mapping[str, str] = tomllib.loads(file.read_text("utf-8"))["reasons"]
    return reasons
