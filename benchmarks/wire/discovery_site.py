"""A network of its own with many stand-ins of agents, to be run by `unshare --net`.

    unshare --net python -m benchmarks.wire.discovery_site multicast|servers COUNT REST_S

Endpoints come as a line of JSON on stdin; what was measured goes to stdout, as JSON.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from discovery_server import discovery_server

from benchmarks.core.stopwatch import cpu_s, resident_mb

ADDRESS = "10.8.0.1"
PORTS = (11811, 11812)
NETWORK = (
    "ip link set lo up",
    "ip link add lan type veth peer name far",
    f"ip addr add {ADDRESS}/24 dev lan",
    "ip link set far up",
    "ip link set lan up",
    "ip route add default dev lan",
)
STAND_IN = str(Path(__file__).with_name("discovery_stand_in.py"))
SETTLE_S = 5.0


def main(how: str, count: int, rest_s: float) -> None:
    """Measure, and write it."""
    endpoints = sys.stdin.readline()
    for command in NETWORK:
        subprocess.run(command.split(), check=True)
    os.environ |= {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4", "ROS_DOMAIN_ID": "1"}
    os.environ |= {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    with ExitStack() as stack:
        servers = []
        if how == "servers":
            servers = [
                stack.enter_context(discovery_server(number, port, ADDRESS))
                for number, port in enumerate(PORTS)
            ]
            os.environ["ROS_DISCOVERY_SERVER"] = ";".join(f"{ADDRESS}:{port}" for port in PORTS)
        agents = [
            stack.enter_context(stand_in(number, count, endpoints)) for number in range(count)
        ]
        sys.stdout.write(json.dumps(measured(agents, servers, rest_s)) + "\n")


@contextmanager
def stand_in(number: int, count: int, endpoints: str) -> "Iterator[subprocess.Popen[str]]":
    """One that has loaded what it needs and waits for a line."""
    command = [sys.executable, STAND_IN, str(number), str(count)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    ) as one:
        try:
            assert one.stdin
            assert one.stdout
            one.stdin.write(endpoints)
            assert one.stdout.readline() == "ready\n"
            yield one
        finally:
            one.kill()


def measured(
    agents: "Sequence[subprocess.Popen[str]]", servers: Sequence[int], rest_s: float
) -> dict[str, float]:
    """From the moment at which all begin at once to when each knows each, and then at rest."""
    before, began = sent(), time.monotonic()
    for one in agents:
        assert one.stdin
        one.stdin.write("go\n")
    ends = [float(one.stdout.readline()) for one in agents if one.stdout]
    found = sent()
    time.sleep(SETTLE_S)
    rest, worked, served = sent(), _worked([one.pid for one in agents]), _worked(servers)
    rested = time.monotonic()
    time.sleep(rest_s)
    now, passed = sent(), time.monotonic() - rested
    work = _worked([one.pid for one in agents]) - worked
    return {
        "time_s": max(ends) - began,
        "megabytes": (found[0] - before[0]) / 1e6,
        "packets": found[1] - before[1],
        "rest_kb_per_s": (now[0] - rest[0]) / 1e3 / passed,
        "cpu_percent": 100 * work / passed / len(agents),
        "server_cpu_percent": 100 * (_worked(servers) - served) / passed,
        "resident_mb": sum(resident_mb(one.pid) for one in agents) / len(agents),
    }


def _worked(processes: Sequence[int]) -> float:
    return sum(cpu_s(one) for one in processes)


def sent() -> tuple[int, int]:
    """Bytes and packets that this network's interfaces have sent; a multicast counts once."""
    lines = Path("/proc/net/dev").read_text("ascii").splitlines()[2:]
    counted = {name.strip(): rest.split() for name, _, rest in (x.partition(":") for x in lines)}
    both = [counted[name] for name in ("lo", "lan")]
    return sum(int(one[8]) for one in both), sum(int(one[9]) for one in both)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]))
