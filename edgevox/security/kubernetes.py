"""An enclave as a Kubernetes Secret."""

import base64

import yaml

from edgevox.core.errors import InvalidValue

LONGEST_NAME = 253


def secret_name(enclave: str) -> str:
    """What the Secret of an enclave is called: ``edgevox-security-robot1-edgevox``."""
    return "edgevox-security" + enclave.replace("/", "-").replace("_", "-").lower()


def secret(files: dict[str, bytes], enclave: str, name: str = "") -> str:
    """A manifest whose keys are the files of an enclave. Raises `InvalidValue` for a bad name."""
    called = name or secret_name(enclave)
    allowed = called.replace("-", "a").replace(".", "a")
    if not (allowed.isascii() and allowed.isalnum() and allowed == allowed.lower()):
        raise InvalidValue("--name", called, "lower-case letters, digits and dashes")
    manifest = {
        "apiVersion": "v1",
        "kind": "Secret",
        "metadata": {"name": called, "annotations": {"edgevox/enclave": enclave}},
        "type": "Opaque",
        "data": {key: base64.b64encode(data).decode() for key, data in files.items()},
    }
    return yaml.safe_dump(manifest, sort_keys=False)
