"""The reasons that robots give, by their codes: English ones stand where all other languages do."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources

from edgevox.core.reasons import Reason, in_english


def because(code: str, text: str = "", /, **values: str | tuple[str, ...] | Reason) -> Reason:
    """The reason of this code. Raises `KeyError` for one that `phrases/en.toml` does not have.

    `text` is the English sentence for programs, where it says more than that of the phrasebook.
    """
    told = {name: in_english(value).rstrip(".") for name, value in values.items()}
    return Reason(text or _english()[code].format(**told), code, values)


@cache
def _english() -> Mapping[str, str]:
    file = resources.files("edgevox.agent.phrases").joinpath("en.toml")
    reasons: Mapping[str, str] = tomllib.loads(file.read_text("utf-8"))["reasons"]
    return reasons
