"""ROS 2: whether it is here, works, and knows our interfaces; which domain and which others."""

from pathlib import Path

from edgevox.apps.container.environment import ENVIRONMENT
from edgevox.apps.container.peers import PEERS, SERVERS, addresses, server_names
from edgevox.apps.doctor.check import (
    CheckVerdict,
    Facts,
    Situation,
    error,
    ok,
    probe_apart,
    skipped,
    warning,
)
from edgevox.apps.doctor.security import NOT_WITH_SECURITY, is_secured
from edgevox.core.errors import install_extra

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
