"""How long agents of one domain take to find each other, and the cost, by their number.

Multicast beside two discovery servers, once for each number. Each agent is a process in a network
namespace that counts what is sent (a multicast once). **Agents are stand-ins**: nodes with the
topics and services of an agent with `--llm none`, which is measured beside them, and no data. All
start at once; each is done when its `/tf` has matched everybody's.
"""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

from benchmarks import ROOT
from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.stopwatch import percent_of, resident_mb
from benchmarks.core.talker import Talker

SITE = ("-m", "benchmarks.wire.discovery_site")
ALONE = ("unshare", "--net")
COUNTS = (2, 10, 25, 50)
COLUMNS = {"multicast": "multicast", "servers": "two discovery servers"}
FIGURES = {
    "time_s": ("Time until everybody knows everybody", "s"),
    "megabytes": ("Sent until then", "MB"),
    "packets": ("Packets until then", "packets"),
    "rest_kb_per_s": ("Sent at rest, all together", "kB/s"),
    "cpu_percent": ("Work at rest of each", "% of a core"),
    "server_cpu_percent": ("Work at rest of the servers", "% of a core"),
}
ONE = "One agent with `--llm none`, and a stand-in"
LIMIT_S = 400.0


def measure(quick: bool = False) -> Measured:
    """One agent, then as many stand-ins as there are counts."""
    if subprocess.run([*ALONE, "true"], check=False, capture_output=True).returncode:
        raise NotHere("no network namespace of one's own: run it as root")
    endpoints, agent = an_agent(5.0 if quick else 15.0)
    counts, rest_s = ((2, 5), 3.0) if quick else (COUNTS, 12.0)
    found: dict[tuple[str, int], dict[str, float]] = {}
    for count in counts:
        for how in COLUMNS:  # side by side, since the machine may be busy
            found[how, count] = site(how, count, rest_s, endpoints)
    largest = found["multicast", max(counts)]["resident_mb"]
    stand_in = Figure.of("stand_in.resident", ONE, "a stand-in: resident", [largest], "MB")
    return Measured(figures=(*agent, stand_in, *_figures(found)))


def an_agent(seconds: float) -> tuple[dict[str, Any], tuple[Figure, ...]]:
    """What a peer sees of an agent's endpoints, and what it takes."""
    with Talker("--llm=none") as talker:
        node = talker.peer.node
        time.sleep(3.0)
        who = next(one for one in node.get_node_names_and_namespaces() if one[0] != "peer")
        said = node.get_publisher_names_and_types_by_node(*who)
        heard = node.get_subscriber_names_and_types_by_node(*who)
        services = len(node.get_service_names_and_types_by_node(*who))
        resident, share = resident_mb(talker.pid), percent_of(talker.pid, seconds)
    endpoints = {"said": _plain(said), "heard": _plain(heard), "services": services}
    number = len(said) + len(heard) + 2 * services
    return endpoints, (
        Figure.of("agent.resident", ONE, "an agent: resident", [resident], "MB"),
        Figure.of("agent.cpu", ONE, "an agent: work at rest", [share], "% of a core"),
        Figure.of("agent.endpoints", ONE, "writers and readers that others see", [number]),
    )


def _plain(topics: list[tuple[str, list[str]]]) -> list[tuple[str, str]]:
    """Those that a stand-in makes itself: `/tf` apart, and what each node has without asking."""
    made = ("/rosout", "/parameter_events", "/tf")
    return [(name, kinds[0]) for name, kinds in topics if name not in made and "/_" not in name]


def site(how: str, count: int, rest_s: float, endpoints: dict[str, Any]) -> dict[str, float]:
    """What a network with so many found."""
    ran = subprocess.run(
        [*ALONE, sys.executable, *SITE, how, str(count), str(rest_s)],
        input=json.dumps(endpoints) + "\n",
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        cwd=ROOT,
        timeout=LIMIT_S,
    )
    return dict(json.loads(ran.stdout.splitlines()[-1]))


def _figures(found: dict[tuple[str, int], dict[str, float]]) -> Iterator[Figure]:
    for key, (table, unit) in FIGURES.items():
        for (how, count), one in found.items():
            if key == "server_cpu_percent" and how == "multicast":
                continue
            # Work at rest may be none at all, to which there is no ratio.
            compared = how == "servers" and "cpu" not in key
            yield Figure.of(
                f"{key}.{how}.{count}", table, f"{count} agents", [one[key]], unit,
                column=COLUMNS[how], baseline=f"{key}.multicast.{count}" if compared else "",
            )  # fmt: skip
