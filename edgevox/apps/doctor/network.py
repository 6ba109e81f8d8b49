"""The checks of multicast, shared memory and buffers, which the middleware uses."""

import fcntl
import os
import secrets
import shutil
import socket
import struct
from collections.abc import Iterator
from pathlib import Path

from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, warning
from edgevox.core.files.user_file import size_bytes
from edgevox.ops.diagnostics import MIB

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
