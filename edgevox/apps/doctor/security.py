"""The check of DDS security: the build of ROS 2, the wanted security, and its expiry."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, warning
from edgevox.core.errors import InvalidValue
from edgevox.core.probe import probe_apart
from edgevox.ros2.open import domain_of
from edgevox.security.startup import (
    ENABLE,
    KEYSTORE,
    NO_SECURITY,
    PROBE,
    Asked,
    asked_security,
    read_enclave,
)

NAMESPACE = "EDGEVOX_AGENT_NAMESPACE"
AGENT = "edgevox-agent"
NOT_WITH_SECURITY = "not tried: the doctor has no enclave of its own"


def is_secured(environment: Mapping[str, str]) -> bool:
    """Return whether nodes of this environment are, or should be, secured."""
    return bool(environment.get(KEYSTORE)) or environment.get(ENABLE) == "true"


def probe_security(situation: Situation) -> Facts:
    """Find the middleware's build, and the agent's enclave."""
    return {"build": probe_apart(PROBE), **_enclave(situation)}


def _enclave(situation: Situation) -> dict[str, Any]:
    facts: dict[str, Any] = {"refused": "", "enclave": "", "wrong": [], "warnings": [], "ends": ""}
    environment = {**situation.environment, NAMESPACE: situation.settings.agent_namespace}
    try:
        asked = asked_security(environment, AGENT)
        return facts | (_state(asked, domain_of(environment)) if asked else {})
    except InvalidValue as failed:
        return facts | {"refused": str(failed)}


def _state(asked: Asked, domain: int) -> dict[str, Any]:
    state = read_enclave(asked.folder, datetime.now(UTC), domain)
    return {
        "enclave": asked.enclave,
        "wrong": list(state.wrong),
        "warnings": list(state.warnings),
        "ends": f"{state.ends:%Y-%m-%d}" if state.ends else "",
    }


def judge_security(facts: Facts, situation: Situation) -> list[CheckVerdict]:
    """Judge security: the wanted one must hold; its absence is reported, and no fault."""
    return [_judge_build(facts["build"]), *_judge_asked(facts, situation)]


def _judge_build(build: Facts) -> CheckVerdict:
    if openssl := build["bundled_openssl"]:
        found = f"ROS 2 of the Python index's wheels, with OpenSSL {openssl} inside"
        return ok(found, "for development and tests; use the official image on robots")
    has = "with" if build["security"] else "without"
    return ok(f"{build['middleware']} {has} DDS security, on the system's OpenSSL")


def _judge_asked(facts: Facts, situation: Situation) -> list[CheckVerdict]:
    if facts["refused"]:
        return [error(facts["refused"], "see docs/security.md; no program starts like this")]
    if not is_secured(situation.environment):
        return [ok("not asked for: any node on the domain can hear and command the robot")]
    if not facts["build"]["security"]:
        found = f"asked for, and {facts['build']['middleware']} has none: nothing starts"
        return [error(found, f"take {NO_SECURITY}")]
    name = facts["enclave"]
    if facts["wrong"]:
        advice = "run edgevox-security renew and export, then restart"
        return [error(f"{name}: {one}", advice) for one in facts["wrong"]]
    soon = [warning(f"{name}: {one}", "docs/security.md") for one in facts["warnings"]]
    if not name:
        return [ok("enforced; --ros-args names its enclave, which was not looked at")]
    return [*soon, ok(f"enforced as {name}, until {facts['ends']}")]
