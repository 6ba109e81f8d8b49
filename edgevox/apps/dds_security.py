"""DDS security (SROS 2) for EdgeVox's programs, if the environment asks for it.

It is enforced, or the program does not start.
"""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from edgevox.apps.doctor.runner import ProbeFailed, probe_apart
from edgevox.apps.enclave_files import enclaves_of, read_enclave
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings
from edgevox.ros2.contract import NODE_NAME, RECORDER_NODE
from edgevox.security.documents import LAST_DOMAIN

KEYSTORE, ENCLAVE = "EDGEVOX_SECURITY_KEYSTORE", "EDGEVOX_SECURITY_ENCLAVE"
ENABLE, STRATEGY = "ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY"
ROS_KEYSTORE, OVERRIDE = "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE"
NAMESPACE, DOMAIN = "EDGEVOX_AGENT_NAMESPACE", "ROS_DOMAIN_ID"
ENFORCE = "Enforce"
PROBE, PROBE_S = "edgevox.ros2.doctor.middleware_build:middleware_build", 60.0
PARTICIPANT_PROBE = "edgevox.ros2.doctor.participant_probe:participant_probe"
UNSEEN = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_DISCOVERY_SERVER": ""}
"""Settings that hide a participant, which is only created as a test."""
NAMES = {"edgevox": NODE_NAME, "edgevox-agent": NODE_NAME, "edgevox-recorder": RECORDER_NODE}
"""The name of each program's enclave, within the robot's namespace."""
TOOLS = "tools"
"""The enclave of all other programs: `ros2`, and people's experiments."""
NO_SECURITY = "a middleware with DDS security, as in the official image ros:jazzy-ros-base"

NOT_TAKEN = (
    "the middleware does not take it; are governance.p7s and permissions.p7s as they were signed?"
)


@dataclass(frozen=True, slots=True)
class Asked:
    """The wanted security: a keystore, and the enclave to be in it."""

    keystore: Path
    enclave: str

    @property
    def folder(self) -> Path:
        """The folder of the enclave's files."""
        return self.keystore / "enclaves" / self.enclave.lstrip("/")

    @property
    def variables(self) -> dict[str, str]:
        """The variables that ROS 2 reads."""
        given = {ENABLE: "true", STRATEGY: ENFORCE, ROS_KEYSTORE: str(self.keystore)}
        return {**given, OVERRIDE: self.enclave}


def asked_security(environment: Mapping[str, str], program: str) -> Asked | None:
    """Return the security that a program is asked for, by its name; None without any.

    Raises `InvalidValue` for a request that is incomplete, or for less than enforcement.
    """
    strategy = environment.get(STRATEGY, "")
    if strategy not in ("", ENFORCE):
        raise InvalidValue(STRATEGY, strategy, ENFORCE)
    if keystore := environment.get(KEYSTORE, ""):
        return _asked(Path(keystore), environment, program)
    if environment.get(ENCLAVE):
        raise InvalidValue(ENCLAVE, environment[ENCLAVE], f"none without {KEYSTORE}")
    enable = environment.get(ENABLE, "")
    if enable not in ("", "false", "true"):  # ROS 2 takes any other word for no
        raise InvalidValue(ENABLE, enable, "true or false, in these letters")
    if enable != "true":
        return None
    if not strategy:
        raise InvalidValue(STRATEGY, "", f"{ENFORCE}, since {ENABLE} is true")
    if not environment.get(OVERRIDE):
        return None  # by --ros-args --enclave: ROS 2 looks at it itself
    return Asked(Path(environment.get(ROS_KEYSTORE, "")), environment[OVERRIDE])


def secured(
    environment: Mapping[str, str], program: str, warn: Callable[[str], None]
) -> dict[str, str]:
    """The environment with what ROS 2 reads, in place of what people say.

    Raises `InvalidValue` where security is asked for and cannot be had; what will be wrong soon
    goes to `warn`.
    """
    asked = asked_security(environment, program)
    if asked and environment.get(KEYSTORE):
        _require_middleware(environment)
        state = read_enclave(asked.folder, datetime.now(UTC), domain_of(environment))
        if state.wrong:
            raise InvalidValue(ENCLAVE, asked.enclave, f"a good one: {'; '.join(state.wrong)}")
        _require_taken(asked, environment)
        for line in state.warnings:
            warn(f"security: {asked.enclave}: {line}")
    rest = {name: one for name, one in environment.items() if name not in (KEYSTORE, ENCLAVE)}
    return rest | (asked.variables if asked else {})


def domain_of(environment: Mapping[str, str]) -> int:
    """The domain of ROS 2's graph that is asked for. Raises `InvalidValue`."""
    said = environment.get(DOMAIN) or "0"
    if not (said.isascii() and said.isdecimal()) or int(said) > LAST_DOMAIN:
        raise InvalidValue(DOMAIN, said, f"0 to {LAST_DOMAIN}")
    return int(said)


def secure_process(program: str, namespace: str, warn: Callable[[str], None]) -> None:
    """The same for this process, before its first node. Raises `InvalidValue`."""
    os.environ.update(secured({**os.environ, NAMESPACE: namespace}, program, warn))


def _asked(keystore: Path, environment: Mapping[str, str], program: str) -> Asked:
    known = enclaves_of(keystore)
    if not known:
        raise InvalidValue(
            KEYSTORE,
            str(keystore),
            f"one that edgevox-security exported, to be read by user {os.getuid()}",
        )
    if os.path.lexists(keystore / "private"):  # whoever has it makes enclaves of its own
        raise InvalidValue(
            KEYSTORE,
            str(keystore),
            "what edgevox-security exports: this is the authority's own, with its private keys",
        )
    asked = Asked(keystore, environment.get(ENCLAVE) or _own(known, environment, program))
    if asked.enclave not in known:
        raise InvalidValue(ENCLAVE, asked.enclave, f"one of the keystore: {', '.join(known)}")
    for name, value in asked.variables.items():
        if environment.get(name, "") not in ("", value):
            raise InvalidValue(name, environment[name], f"{value}, as {KEYSTORE} has it")
    return asked


def _own(known: list[str], environment: Mapping[str, str], program: str) -> str:
    """The program's own, or the only one that this robot's namespace has."""
    default = Settings.model_fields["agent_namespace"].default
    namespace = (environment.get(NAMESPACE) or default).rstrip("/")
    own = f"{namespace}/{NAMES.get(Path(program).name, TOOLS)}"
    of_robot = [one for one in known if one.startswith(f"{namespace}/")]
    return of_robot[0] if len(of_robot) == 1 else own


def _require_middleware(environment: Mapping[str, str]) -> None:
    given = environment.get("RMW_IMPLEMENTATION", "")
    try:
        facts = probe_apart(PROBE, given, timeout_s=PROBE_S)
    except ProbeFailed as failed:
        raise InvalidValue(KEYSTORE, environment[KEYSTORE], f"{NO_SECURITY}: {failed}") from None
    if not facts["security"]:
        name = facts["middleware"] or "no ROS 2"
        raise InvalidValue(
            KEYSTORE, environment[KEYSTORE], f"{NO_SECURITY}; here is {name} without it"
        )


def _require_taken(asked: Asked, environment: Mapping[str, str]) -> None:
    given = {**environment, **asked.variables, **UNSEEN}
    try:
        taken = probe_apart(PARTICIPANT_PROBE, environment=given, timeout_s=PROBE_S)["taken"]
    except ProbeFailed as failed:
        raise InvalidValue(ENCLAVE, asked.enclave, f"a good one: {failed}") from None
    if not taken:
        raise InvalidValue(ENCLAVE, asked.enclave, f"a good one: {NOT_TAKEN}")
