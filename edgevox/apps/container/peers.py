"""The peers of ROS_STATIC_PEERS as addresses, without names that do not resolve now.

A node looks its peers up once, when it is made, and is not made at all if one of them does not
resolve: a robot whose peer is down would not come up. So names are looked up here, for a bounded
time, and a name without an address by then is left out and reported.

If each of two robots names the other, the wait is long enough once it exceeds the time in which a
new name becomes known: then at least one of them finds the other, which is enough for both.

It also looks up the servers of ROS_DISCOVERY_SERVER; a server without an address leaves its place
empty. Fast DDS takes none of the list if one name in it does not resolve: with one of two servers
down a node would find no peer. A server's number is its place in the list, so a place stays.
"""

import re
import socket
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from threading import Event

PEERS = "ROS_STATIC_PEERS"
WAIT = "EDGEVOX_PEERS_WAIT_S"
AGAIN_S = 0.5
"""Seconds after which an unknown name is looked up again."""
ANSWER_S = 2.0
"""Seconds that the last lookup may take: a dead name server holds up no start."""

LookUp = Callable[[str], str | None]


def address_of(host: str) -> str | None:
    """The address that a node would take: the first of IPv4, else of IPv6; none if unknown."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_DGRAM)
    except (OSError, UnicodeError):
        return None
    first = {family: str(address[0]) for family, *_, address in reversed(found)}
    return first.get(socket.AF_INET) or first.get(socket.AF_INET6)


def with_addresses(
    environment: Mapping[str, str], warn: Callable[[str], None], look_up: LookUp = address_of
) -> dict[str, str]:
    """Return the environment with peers as addresses.

    A peer without one is left out and reported.
    """
    names = environment.get(PEERS, "").split(";")
    rest = {name: value for name, value in environment.items() if name != PEERS}
    if names == [""]:
        return rest
    wait_s = int(environment[WAIT])
    known = addresses(names, wait_s, look_up)
    if missing := [name for name in names if name not in known]:
        warn(
            f"{PEERS}: left out after {wait_s} s, for there is no address of {', '.join(missing)};"
            " such a peer is found when it names this one, else when this one starts again"
        )
    found = [known[name] for name in names if name in known]
    return rest | ({PEERS: ";".join(found)} if found else {})


def addresses(names: Iterable[str], wait_s: float, look_up: LookUp = address_of) -> dict[str, str]:
    """The addresses of those that have one within `wait_s` seconds; each is asked at least once."""
    over = Event()
    pool = ThreadPoolExecutor(thread_name_prefix="edgevox-peers", max_workers=64)
    asked = {name: pool.submit(_ask, name, look_up, over) for name in dict.fromkeys(names)}
    wait(asked.values(), timeout=wait_s)
    over.set()
    wait(asked.values(), timeout=ANSWER_S)
    pool.shutdown(wait=False, cancel_futures=True)
    found = {name: one.result() for name, one in asked.items() if one.done()}
    return {name: address for name, address in found.items() if address}


def _ask(name: str, look_up: LookUp, over: Event) -> str | None:
    """Ask until there is an answer, or until it is over."""
    while True:
        if (address := look_up(name)) or over.wait(AGAIN_S):
            return address


SERVERS = "ROS_DISCOVERY_SERVER"
ROUND_S = 10
"""Seconds of simultaneous lookups while no peer has an address."""
SAY_EVERY = 6
"""Rounds between two log lines that there is no peer."""
_PARTS = re.compile(r"(?P<kind>\w+:)?\[(?P<inside>[^]]*)\](?P<end>.*)|(?P<host>[^:]*)(?P<port>.*)")
"""TCPv4:[host]:port, [IPv6]:port or host:port."""


def server_names(servers: str) -> list[str]:
    """The host names or addresses in a value of ROS_DISCOVERY_SERVER, in their order."""
    return [_host(server) for server in servers.split(";") if server]


def with_server_addresses(
    environment: Mapping[str, str], warn: Callable[[str], None], look_up: LookUp = address_of
) -> dict[str, str]:
    """Return the environment with servers as addresses; one without is left out and reported.

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
