"""The servers of ROS_DISCOVERY_SERVER as addresses, the places of those that have none left empty.

Fast DDS takes none of the list if one name in it does not resolve: with one of two servers down
whoever starts would find nobody. A server's number is its place in the list, so a place stays.
"""

import re
from collections.abc import Callable, Mapping

from edgevox.apps.container.static_peers import WAIT, LookUp, address_of, addresses

SERVERS = "ROS_DISCOVERY_SERVER"
ROUND_S = 10
"""How long all are asked for at once while none has an address."""
SAY_EVERY = 6
"""In each so many rounds it is said that there is none."""
_PARTS = re.compile(r"(?P<kind>\w+:)?\[(?P<inside>[^]]*)\](?P<end>.*)|(?P<host>[^:]*)(?P<port>.*)")
"""TCPv4:[host]:port, [IPv6]:port or host:port."""


def server_names(servers: str) -> list[str]:
    """The host names or addresses in a value of ROS_DISCOVERY_SERVER, in their order."""
    return [_host(server) for server in servers.split(";") if server]


def with_server_addresses(
    environment: Mapping[str, str], warn: Callable[[str], None], look_up: LookUp = address_of
) -> dict[str, str]:
    """The environment with addresses for servers; who has none is left out, and named to `warn`.

    While none of them has an address it waits: a robot that started without any would look for
    others by multicast, and would not ask a server that comes later.
    """
    servers = environment.get(SERVERS, "")
    if not (names := server_names(servers)):
        return dict(environment)
    wait_s = int(environment[WAIT])
    known = addresses(names, wait_s, look_up) or _first_known(names, warn, look_up)
    if missing := [name for name in dict.fromkeys(names) if name not in known]:
        warn(
            f"{SERVERS}: left out after {wait_s} s, for there is no address of"
            f" {', '.join(missing)}; such a server is asked when this one starts again"
        )
    places = [_placed(server, known) for server in servers.split(";")]
    return {**environment, SERVERS: ";".join(places)}


def _first_known(names: list[str], warn: Callable[[str], None], look_up: LookUp) -> dict[str, str]:
    """The addresses of those that have one, as soon as there is any."""
    rounds = 0
    while True:
        if rounds % SAY_EVERY == 0:
            said = ", ".join(dict.fromkeys(names))
            warn(f"{SERVERS}: there is no address of {said}; it waits until there is one")
        if known := addresses(names, ROUND_S, look_up):
            return known
        rounds += 1


def _host(server: str) -> str:
    parts = _PARTS.fullmatch(server)
    return (parts["inside"] or parts["host"] or "") if parts else server


def _placed(server: str, known: Mapping[str, str]) -> str:
    """A server with its address in place of its name; nothing if there is none."""
    parts, address = _PARTS.fullmatch(server), known.get(_host(server))
    if not parts or not address:
        return ""
    kind, end = parts["kind"] or "", parts["end"] or parts["port"] or ""
    return f"{kind}[{address}]{end}" if kind or ":" in address else f"{address}{end}"
