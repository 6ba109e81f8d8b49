"""DDS security (SROS 2) for EdgeVox's programs, if the environment asks for it.

It is enforced, or the program does not start. `read_enclave` tells whether an enclave's files are
complete, whose key it is, and when its certificates end.
"""

import os
import re
import ssl
import stat
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, size_bytes
from edgevox.core.probe import ProbeFailed, probe_apart
from edgevox.core.settings import Settings
from edgevox.ros2.contract import NODE_NAME, RECORDER_NODE
from edgevox.ros2.open import LAST_DOMAIN, domain_of

KEYSTORE, ENCLAVE = "EDGEVOX_SECURITY_KEYSTORE", "EDGEVOX_SECURITY_ENCLAVE"
ENABLE, STRATEGY = "ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY"
ROS_KEYSTORE, OVERRIDE = "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE"
NAMESPACE = "EDGEVOX_AGENT_NAMESPACE"
ENFORCE = "Enforce"
PROBE, PROBE_S = "edgevox.ros2.doctor:middleware_build", 60.0
PARTICIPANT_PROBE = "edgevox.ros2.doctor:participant_probe"
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


CERTIFICATES = ("cert.pem", "identity_ca.cert.pem", "permissions_ca.cert.pem")
KEY, PERMISSIONS, GOVERNANCE = "key.pem", "permissions.p7s", "governance.p7s"
NEEDED = (*CERTIFICATES, KEY, PERMISSIONS, GOVERNANCE)
"""The files that a participant reads, by sros2's names."""
SOON = timedelta(days=30)
_UTC_TIME, _GENERALIZED_TIME, _VERSION = 0x17, 0x18, 0xA0
_GRANTED = re.compile(r"<not_(?:before|after)>\s*(\S+?)\s*</not_(before|after)>")
_ALLOWED = re.compile(r"<allow_rule>.*?<domains>(.*?)</domains>", re.DOTALL)
_DOMAINS = re.compile(
    r"<id>\s*(\d{1,9})\s*</id>"
    r"|<id_range>\s*(?:<min>\s*(\d{1,9})\s*</min>\s*)?(?:<max>\s*(\d{1,9})\s*</max>\s*)?</id_range>"
)
_LETS_IN = re.compile(
    r"<(allow_unauthenticated_participants)>\s*(?:true|1)\b"
    r"|<(enable_join_access_control)>\s*(?:false|0)\b",
    re.IGNORECASE,
)
"""Rules of a governance file that undo Enforce: they admit strangers to a domain."""


@dataclass(frozen=True, slots=True)
class EnclaveState:
    """The state of an enclave's files."""

    wrong: tuple[str, ...]
    """The faults."""
    warnings: tuple[str, ...]
    """The faults to come."""
    ends: datetime | None = None
    """The first end of a file's validity, if it can be read."""


def enclaves_of(keystore: Path) -> list[str]:
    """The enclaves that a keystore holds and this user may see, such as ``/robot1/edgevox``."""
    root, found = keystore / "enclaves", list[str]()
    for folder, below, files in os.walk(root):
        # Kubernetes keeps a Secret's files twice, once in a folder whose name begins with dots.
        below[:] = [name for name in below if not name.startswith(".")]
        if CERTIFICATES[0] in files:
            found.append(f"/{Path(folder).relative_to(root)}")
    return sorted(found)


def read_enclave(folder: Path, now: datetime, domain: int) -> EnclaveState:
    """Read an enclave's state; a missing, expired or foreign-domain file is a fault.

    A participant without rights on a domain would start there all the same, and be deaf.
    """
    wrong = [said for name in NEEDED if (said := _unreadable(folder / name))]
    if wrong:
        return EnclaveState(tuple(wrong), ())
    try:
        periods = {name: _period_of(folder / name) for name in CERTIFICATES}
    except ValueError as error:
        return EnclaveState((str(error),), ())
    granting = _text(folder / PERMISSIONS)
    if granted := _granted_period(granting):
        periods[PERMISSIONS] = granted
    wrong = [said for name, period in periods.items() if (said := _out_of_date(name, period, now))]
    if not _are_a_pair(folder / CERTIFICATES[0], folder / KEY):
        wrong.append(f"{KEY} is no key of {CERTIFICATES[0]}")
    if (told := _domains(granting)) and not any(domain in one for one in told):
        wrong.append(f"{PERMISSIONS} is for ROS_DOMAIN_ID {_named(told)}, and here it is {domain}")
    if strangers := _LETS_IN.search(_text(folder / GOVERNANCE)):
        wrong.append(f"{GOVERNANCE} lets strangers in, by {strangers[1] or strangers[2]}")
    warnings = [
        f"{name} ends {at:%Y-%m-%d}" for name, (_, at) in periods.items() if at < now + SOON
    ]
    if (folder / KEY).stat().st_mode & stat.S_IROTH:
        warnings.append(f"{KEY} can be read by everybody on its machine: chmod o= {KEY}")
    first = min(at for _, at in periods.values())
    return EnclaveState(tuple(wrong), () if wrong else tuple(warnings), first)


def certificate_period(pem: str) -> tuple[datetime, datetime]:
    """Return the begin and end of a certificate (X.509, PEM). Raises `ValueError`."""
    try:
        (_, certificate), *_ = _elements(ssl.PEM_cert_to_DER_cert(pem.strip()))
        (_, signed), *_ = _elements(certificate)
        tags = [one for one in _elements(signed) if one[0] != _VERSION]
        begins, ends = (_time(*one) for one in _elements(tags[3][1]))
    except (LookupError, ValueError) as error:
        raise ValueError("no certificate in PEM") from error
    return begins, ends


def _unreadable(file: Path) -> str:
    if os.access(file, os.R_OK):  # a pipe would be waited for, a device may have no end
        small = file.is_file() and size_bytes(file) <= LARGEST_TEXT_BYTES
        return "" if small else f"{file.name} is no file of {LARGEST_TEXT_BYTES} bytes at most"
    refused = os.path.lexists(file) or not os.access(file.parent, os.X_OK)
    return f"{file.name} {f'cannot be read by user {os.getuid()}' if refused else 'is missing'}"


def _text(file: Path) -> str:
    return file.read_text(encoding="ascii", errors="replace")


def _period_of(file: Path) -> tuple[datetime, datetime]:
    try:
        return certificate_period(_text(file))
    except ValueError as error:
        raise ValueError(f"{file.name}: {error}") from None


def _granted_period(text: str) -> tuple[datetime, datetime] | None:
    """Return the time in which all grants of a permissions file hold, if its XML is readable."""
    at = {"before": list[datetime](), "after": list[datetime]()}
    for written, which in _GRANTED.findall(text):
        with suppress(ValueError):
            moment = datetime.fromisoformat(written)
            at[which].append(moment if moment.tzinfo else moment.replace(tzinfo=UTC))
    return (max(at["before"]), min(at["after"])) if at["before"] and at["after"] else None


def _domains(text: str) -> list[range]:
    """Return the domains on which something is allowed, if the XML is readable."""
    found = [one for rule in _ALLOWED.findall(text) for one in _DOMAINS.findall(rule)]
    return [
        range(int(one or least or 0), int(one or most or LAST_DOMAIN) + 1)
        for one, least, most in found
    ]


def _named(domains: list[range]) -> str:
    return ", ".join(
        f"{one.start}" if len(one) == 1 else f"{one.start} to {one.stop - 1}" for one in domains
    )


def _out_of_date(name: str, period: tuple[datetime, datetime], now: datetime) -> str:
    begins, ends = period
    if now >= ends:
        return f"{name} ended {ends:%Y-%m-%d %H:%M} UTC"
    if now < begins:
        return f"{name} begins {begins:%Y-%m-%d %H:%M} UTC: is the clock right?"
    return ""


def _are_a_pair(certificate: Path, key: Path) -> bool:
    try:
        # An empty password: nobody is there to be asked for one.
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(certificate, key, password="")
    except (ssl.SSLError, ValueError):
        return False
    return True


def _elements(der: bytes) -> Iterator[tuple[int, bytes]]:
    """Each element's tag and content, of DER with tags of one byte."""
    at = 0
    while at < len(der):
        tag, length, at = der[at], der[at + 1], at + 2
        if length & 0x80:
            size = length & 0x7F
            length, at = int.from_bytes(der[at : at + size]), at + size
        yield tag, der[at : at + length]
        at += length


def _time(tag: int, content: bytes) -> datetime:
    form = {_UTC_TIME: "%y%m%d%H%M%SZ", _GENERALIZED_TIME: "%Y%m%d%H%M%SZ"}[tag]
    return datetime.strptime(content.decode("ascii"), form).replace(tzinfo=UTC)
