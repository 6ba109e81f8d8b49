"""What settings may be where a type alone does not say it: each is refused in words for people."""

import re
from typing import Annotated

from pydantic import AfterValidator

from edgevox.core.frame_names import PREFIX_EXPECTED, is_prefix
from edgevox.core.languages import LANGUAGES

_NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+|/")
_ENDPOINT = re.compile(r"https?://(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]+)(:[0-9]{1,5})?(/[\w./~-]*)?")


def _known_language(code: str) -> str:
    if code not in LANGUAGES:
        raise ValueError("one of " + ", ".join(LANGUAGES))
    return code


def _valid_namespace(namespace: str) -> str:
    absolute = namespace if namespace.startswith("/") else f"/{namespace}"
    if not _NAMESPACE.fullmatch(absolute) or "__" in absolute:
        raise ValueError(
            "a ROS 2 namespace such as /robot1: letters, digits and single underscores"
        )
    return absolute


def _valid_prefix(prefix: str) -> str:
    if not is_prefix(prefix):
        raise ValueError(PREFIX_EXPECTED)
    return prefix


def _valid_endpoint(url: str) -> str:
    if url and not _ENDPOINT.fullmatch(url):
        raise ValueError(
            "the address of a server such as http://llm.example:8080; its key stands in "
            "llm_endpoint_key_file"
        )
    return url


LanguageCode = Annotated[str, AfterValidator(_known_language)]
"""The code of a language that there is."""
RosNamespace = Annotated[str, AfterValidator(_valid_namespace)]
"""A namespace of ROS 2, made absolute."""
FramePrefix = Annotated[str, AfterValidator(_valid_prefix)]
"""What may stand before the names of frames."""
Endpoint = Annotated[str, AfterValidator(_valid_endpoint)]
"""A server's address without a key in it; empty for none."""
