"""ROS 2: whether it is here, works, and knows our interfaces; which domain and which others.

Also here: multicast, shared memory and buffers, which the middleware uses; and DDS security: the
build of ROS 2, the wanted security, and its expiry.
"""

import fcntl
import os
import secrets
import shutil
import socket
import struct
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from edgevox.apps.container.environment import ENVIRONMENT
from edgevox.apps.container.peers import PEERS, SERVERS, addresses, server_names
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, skipped, warning
from edgevox.core.errors import InvalidValue, install_extra
from edgevox.core.files.user_file import size_bytes
from edgevox.core.probe import probe_apart
from edgevox.ops.machine import MIB
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


DOMAIN, RANGE = "ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE"
ROUND_TRIP = "edgevox.ros2.doctor:round_trip"
_FIRST_PORT, _PORTS = 7400, 250  # of a domain, by RTPS
_DEFAULT_RANGE = (32768, 60999)
_MOST_MS = 100.0


def judge_middleware(facts: Facts, situation: Situation) -> CheckVerdict:
    """A ROS 2 that is missing is wrong only if it was asked for."""
    if facts["missing"]:
        found = f"ROS 2 is not installed ({facts['missing']})"
        advice = f"source /opt/ros/jazzy/setup.bash, or {install_extra('ros2')} on x86-64"
        return (error if situation.settings.ros2 else skipped)(found, advice)
    if facts["failed"]:
        asked = situation.environment.get("RMW_IMPLEMENTATION", "")
        here = ", ".join(facts["installed"]) or "none that the ament index names"
        advice = f"RMW_IMPLEMENTATION={asked}; installed: {here}"
        return error(f"the middleware does not load: {facts['failed']}", advice)
    distro = situation.environment.get("ROS_DISTRO", "")
    if distro not in ("", "jazzy"):
        return warning(f"rclpy of ROS 2 {distro}", "EdgeVox is tested with Jazzy")
    return ok(f"rclpy works, on {facts['middleware']}")


def judge_interfaces(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge the interfaces: without them, everything works but their topics."""
    if not facts["missing"]:
        return ok("all there")
    found = f"missing: {', '.join(facts['missing'])}"
    return warning(found, "make msgs, or colcon build, adds the action, sound and /tf")


def probe_domain(situation: Situation) -> Facts:
    """The domain, and the ports that the kernel gives to programs."""
    low, high = _DEFAULT_RANGE
    file = Path("/proc/sys/net/ipv4/ip_local_port_range")
    if file.is_file():
        low, high = map(int, file.read_text(encoding="ascii").split())
    return {"domain": situation.environment.get(DOMAIN, ""), "low": low, "high": high}


def judge_domain(facts: Facts, _: Situation) -> CheckVerdict:
    """Ports of the domain that are the kernel's to give may be taken."""
    row, given = ENVIRONMENT[DOMAIN], facts["domain"]
    least, most = row.least or 0, row.most or 0
    if not given:
        return ok("0, because ROS_DOMAIN_ID is not set; other robots without it share this domain")
    if not (given.isascii() and given.isdigit()) or not least <= int(given) <= most:
        return error(f"{DOMAIN}={given!r}", f"a whole number from {least} to {most}")
    first = _FIRST_PORT + _PORTS * int(given)
    if first <= facts["high"] and first + _PORTS > facts["low"]:
        found = f"{given}: the kernel may give its ports from {first} to other programs"
        return warning(found, "0 to 101 are safe everywhere")
    return ok(f"{given}, ports from {first}")


def probe_discovery(situation: Situation) -> Facts:
    """The variables that decide how others are found."""
    names = (RANGE, PEERS, "ROS_LOCALHOST_ONLY", SERVERS)
    facts = {name: situation.environment.get(name, "") for name in names}
    peers = [name for name in facts[PEERS].split(";") if name]
    servers = server_names(facts[SERVERS])
    return {**facts, "unknown": _unknown(peers), "unknown_servers": _unknown(servers)}


def _unknown(names: list[str]) -> list[str]:
    """Return the names without an address now."""
    known = addresses(names, 0) if names else {}
    return [name for name in names if name not in known]


def judge_discovery(facts: Facts, _: Situation) -> list[CheckVerdict]:
    """Words that do not exist, and contradictions."""
    said, how = [], facts[RANGE] or "SUBNET"
    known = ENVIRONMENT[RANGE].choices
    if how not in known:
        said.append(error(f"{RANGE}={how}", f"one of {', '.join(known)}"))
    if how == "OFF" and not facts[PEERS]:
        said.append(warning(f"{RANGE}=OFF without {PEERS}: no node is found", "set one of them"))
    if facts["unknown"]:
        found = f"{PEERS}: no address of {', '.join(facts['unknown'])}; no node starts like this"
        said.append(error(found, "remove them; the container's entrypoint does so by itself"))
    if facts["unknown_servers"]:
        found = f"{SERVERS}: no address of {', '.join(facts['unknown_servers'])}; none of it counts"
        said.append(error(found, "leave their places empty; the container's entrypoint does so"))
    if facts["ROS_LOCALHOST_ONLY"]:
        advice = f"use {RANGE}=LOCALHOST instead; the old variable overrules the new ones"
        said.append(warning(f"ROS_LOCALHOST_ONLY={facts['ROS_LOCALHOST_ONLY']}", advice))
    server = facts[SERVERS]
    peers = facts[PEERS]
    more = f", server {server}" if server else f", also {peers}" if peers else ""
    only = ": this machine only" if how == "LOCALHOST" else ""
    return said or [ok(f"{how}{only}{more}")]


def probe_round_trip(situation: Situation) -> Facts:
    """Measure a message's round trip to another process, unless security forbids its topic."""
    if is_secured(situation.environment):
        return {"secured": True}
    return probe_apart(ROUND_TRIP)


def judge_round_trip(facts: Facts, situation: Situation) -> CheckVerdict:
    """The one test that counts: everything before it may be right, and this not."""
    if facts.get("secured"):
        return skipped(NOT_WITH_SECURITY)
    if facts["trip_ms"] is None:
        advice = (
            "try FASTDDS_BUILTIN_TRANSPORTS=UDPv4; in containers of one host, ipc: host or a"
            " network of their own; stop all nodes and rm /dev/shm/fastrtps_*"
        )
        alone = situation.environment.get(RANGE) == "OFF"
        found = f"two nodes of this machine did not hear each other within {facts['tried_s']:g} s"
        return (warning if alone else error)(found, advice)
    found = (
        f"two nodes met after {facts['met_s']:.1f} s, there and back in {facts['trip_ms']:.1f} ms"
    )
    if facts["trip_ms"] > _MOST_MS:
        return warning(found, "this machine is busy")
    return ok(found)


GROUP = "239.255.0.1"
"""The group in which DDS discovers other participants."""
HEAR_S = 1.0
SHM = Path("/dev/shm")  # noqa: S108 - the kernel's name for it
LEAST_SHM_MIB = 64
MOST_STALE_MIB = 32
WANTED_BUFFER = 2 * MIB
_SIOCGIFADDR = 0x8915


def probe_multicast(_: Situation) -> Facts:
    """Test multicast on each interface with an address; the result is the reason of a failure."""
    return {"interfaces": {f"{name} {ip}": _hears_itself(ip) for name, ip in _addresses()}}


def judge_multicast(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge multicast: one working interface to the outside is enough."""
    heard = facts["interfaces"]
    works = [name for name, why in heard.items() if not why]
    outside = [name for name in works if not name.startswith("lo ")]
    advice = "use ROS_STATIC_PEERS or a discovery server (compose/discovery.yml)"
    if outside:
        return ok(f"works on {', '.join(outside)}")
    if all(name.startswith("lo ") for name in heard):
        return ok("no network: EdgeVox reaches only this machine")
    broken = "; ".join(f"{name}: {why}" for name, why in heard.items() if why)
    return warning(f"does not work: {broken}", f"EdgeVox cannot find other machines: {advice}")


def probe_shared_memory(_: Situation) -> Facts:
    """Return its size, and the segments that dead nodes left in it."""
    if not SHM.is_dir():
        return {"there": False}
    space = shutil.disk_usage(SHM)
    stale = [file for file in _segments() if not _in_use(file)]
    return {
        "there": True,
        "writable": os.access(SHM, os.W_OK),
        "size_mib": space.total // MIB,
        "free_mib": space.free // MIB,
        "stale": len(stale),
        "stale_mib": sum(map(size_bytes, stale)) // MIB,
    }


def judge_shared_memory(facts: Facts, _: Situation) -> CheckVerdict:
    """Judge shared memory: without room in it, a node reaches no other on this machine."""
    udp = "or FASTDDS_BUILTIN_TRANSPORTS=UDPv4"
    if not facts["there"] or not facts["writable"]:
        return warning(f"{SHM} cannot be written", f"mount it, {udp}")
    found = f"{facts['free_mib']} of {facts['size_mib']} MiB free"
    if facts["stale"]:
        found += f", {facts['stale_mib']} MiB in {facts['stale']} segments of nodes that are gone"
    if facts["free_mib"] < 1:
        return error(found, f"stop all nodes and rm {SHM}/fastrtps_*, {udp}")
    if facts["stale_mib"] > MOST_STALE_MIB:
        return warning(found, f"stop all nodes and rm {SHM}/fastrtps_* {SHM}/sem.fastrtps_*")
    if facts["size_mib"] < LEAST_SHM_MIB:
        return warning(found, f"give the container shm_size: 256m, {udp}")
    return ok(found)


def probe_buffers(_: Situation) -> Facts:
    """The most that a socket may ask for."""
    file = Path("/proc/sys/net/core/rmem_max")
    return {"rmem_max": int(file.read_text(encoding="ascii")) if file.is_file() else None}


def judge_buffers(facts: Facts, _: Situation) -> CheckVerdict:
    """Never worse than a hint: words need little."""
    most = facts["rmem_max"]
    if most is None:
        return ok("unknown here; the host decides")
    if most < WANTED_BUFFER:
        advice = f"for pictures to other machines: sudo sysctl -w net.core.rmem_max={WANTED_BUFFER}"
        return ok(f"{most // 1024} KiB: enough for words", advice)
    return ok(f"{most // 1024} KiB")


def _addresses() -> Iterator[tuple[str, str]]:
    """The interfaces of this machine that have an IPv4 address."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode()[:15])
            try:
                answer = fcntl.ioctl(asking.fileno(), _SIOCGIFADDR, request)
            except OSError:
                continue
            yield name, socket.inet_ntoa(answer[20:24])


def _hears_itself(ip: str) -> str:
    """Return the reason why a packet to the group is not heard on this interface.

    Empty if it is.
    """
    said = secrets.token_bytes(16)
    try:
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as hearing,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sending,
        ):
            hearing.bind((GROUP, 0))
            membership = socket.inet_aton(GROUP) + socket.inet_aton(ip)
            hearing.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            hearing.settimeout(HEAR_S)
            sending.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(ip))
            sending.sendto(said, hearing.getsockname())
            return "" if hearing.recv(64) == said else "something else was heard"
    except TimeoutError:
        return "nothing is heard"
    except OSError as failed:
        return failed.strerror or str(failed)


def _segments() -> list[Path]:
    """Fast DDS's memory of a node each, of whoever this process may look at."""
    locks = (file for file in SHM.glob("fastrtps_*_el") if "_port" not in file.name)
    segments = (file.with_name(file.name.removesuffix("_el")) for file in locks)
    return [file for file in segments if os.access(file, os.R_OK)]


def _in_use(file: Path) -> bool:
    """Return whether its node lives: that holds an exclusive lock on the file beside it."""
    try:
        with file.with_name(f"{file.name}_el").open("rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False
