"""Which known vulnerabilities the image's packages and the locks have, by OSV: `make scan`.

OSV is a service, or a database on the disk, which needs no network.

Python packages come from requirements/*.lock and the image's bill of materials, Debian's and
Ubuntu's from the latter, npm's from requirements/page. Exit code: 0 none is known, 1 some are, 2
called wrongly, 3 it could not look at all that it should have looked at.
"""

import argparse
import json
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, unquote

import httpx
from osv_database import IDENTIFIER, MALFORMED, CouldNotLook, Looked, Package, look_up, python_name
from provenance import SBOM_IN_IMAGE, Image

ROOT = Path(__file__).resolve().parent.parent
LOCKS = ROOT / "requirements"
SERVICE = "https://api.osv.dev"
BATCH = 500
"""Questions at once; the service takes a thousand."""
PAGES = 20
TIMEOUT_S = 60.0
"""For one answer, to its end."""
MOST_BYTES = 64 << 20
CLEAN, FOUND, BLIND = 0, 1, 3
LOCKED = re.compile(r"^([\w.-]+)==([^\s;\\]+)", re.MULTILINE)
UNFOLLOWED = re.compile(r"ros-|edgevox-robot$")
"""Names of packages that no list of vulnerabilities follows: ROS 2's, and this one."""
ROS = "pkg:generic/ros/"
"""The packages of ROS 2 in a bill of materials, likewise."""


@dataclass
class Contents:
    """What there is to look at."""

    where: dict[Package, set[str]] = field(default_factory=dict)
    """Each package, with the locks and images that it is in."""
    unfollowed: set[str] = field(default_factory=set)
    """Names of packages of which nobody is told anything."""
    unknown: list[str] = field(default_factory=list)
    """What should be looked at and cannot be."""

    def add(self, package: Package, place: str) -> None:
        """Note one package."""
        if UNFOLLOWED.match(package.name):
            self.unfollowed.add(package.name)
        else:
            self.where.setdefault(package, set()).add(place)


def main(arguments: Sequence[str] | None = None) -> int:
    """Look and tell."""
    parser = argparse.ArgumentParser("scan.py", description=__doc__)
    parser.add_argument("--image", default="edgevox-ros2:local", help="whose SBOM is looked at")
    parser.add_argument("--sbom", type=Path, help="a kept SBOM in place of the image's")
    asked = parser.add_mutually_exclusive_group()
    asked.add_argument("--service", default=SERVICE, help="an OSV service, by its address")
    asked.add_argument(
        "--db", type=Path, help="OSV's all.zip, or a folder of them or of entries: no network"
    )
    options = parser.parse_args(arguments)
    contents = Contents()
    add_locks(contents)
    add_page_lock(contents)
    add_sbom(contents, options.sbom, options.image)
    look = (
        partial(look_up, path=options.db) if options.db else partial(ask, service=options.service)
    )
    try:
        looked = look(sorted(contents.where))
    except CouldNotLook as error:
        say(f"could not look: {error}")
        return BLIND
    return tell(looked, contents, str(options.db or options.service))


def add_locks(contents: Contents) -> None:
    """All that requirements/*.lock name."""
    for lock in sorted(LOCKS.glob("*.lock")):
        for name, version in LOCKED.findall(lock.read_text(encoding="utf-8")):
            contents.add(python_package(name, version), lock.name)


def add_page_lock(contents: Contents) -> None:
    """What checks the pages; nothing of it is shipped."""
    lock = LOCKS / "page" / "package-lock.json"
    packages = json.loads(lock.read_text(encoding="utf-8"))["packages"]
    for path, about in packages.items():
        if name := path.rpartition("node_modules/")[2]:
            contents.add(Package("npm", name, about["version"]), "page/package-lock.json")


def add_sbom(contents: Contents, sbom: Path | None, image: str) -> None:
    """All libraries of a bill of materials, the image's or one that was kept."""
    place = str(sbom or image)
    try:
        text = sbom.read_bytes() if sbom else Image.named(image).read(SBOM_IN_IMAGE)
        components = [
            (purl, one)
            for one in json.loads(text)["components"]
            if not (purl := one.get("purl") or "").startswith(ROS)
        ]
        looked_at = [(package_of(purl), one) for purl, one in components]
        unnamed = [
            str(one["name"])
            for package, one in looked_at
            if not package and one.get("type") == "library"
        ]
    except subprocess.CalledProcessError as error:
        contents.unknown.append(f"{place}: {error.stderr.decode().strip()}")
        return
    except (OSError, *MALFORMED) as error:
        contents.unknown.append(f"{place}: no bill of materials: {error}")
        return
    for package, _ in looked_at:
        if package:
            contents.add(package, place)
    if unnamed:
        listed = ", ".join(unnamed[:3]) + (", ..." if len(unnamed) > 3 else "")
        why = f"{place} does not say of which release, or OSV does not know it"
        contents.unknown.append(f"{len(unnamed)} packages, {why}: {listed}")


def package_of(purl: str) -> Package | None:
    """What a package URL names, if OSV follows its kind. Debian's go by the source they are of."""
    path, _, more = purl.partition("?")
    qualifiers = {name: values[0] for name, values in parse_qs(more).items()}
    if found := re.fullmatch(r"pkg:pypi/([^@]+)@(.+)", path):
        return python_package(unquote(found[1]), unquote(found[2]))
    if path.startswith("pkg:deb/") and (ecosystem := release(qualifiers.get("distro", ""))):
        source, _, version = qualifiers.get("upstream", "").partition("@")
        return Package(ecosystem, source, version) if source and version else None
    return None


def python_package(name: str, version: str) -> Package:
    """A package of the Python index, by the one spelling of its name that OSV knows."""
    return Package("PyPI", python_name(name), version)


def release(distro: str) -> str:
    """OSV's name of a release, such as Debian:12; empty for one that it does not follow."""
    name, _, number = distro.partition("-")
    if name == "debian":
        return f"Debian:{number}"
    if name == "ubuntu":
        long = re.fullmatch(r"\d[02468]\.04", number)
        return f"Ubuntu:{number}:LTS" if long else f"Ubuntu:{number}"
    return ""


def ask(packages: Sequence[Package], service: str) -> Looked:
    """What the service knows of them.

    Raises `CouldNotLook` for anything but a whole answer.
    """
    looked = Looked()
    questions = [(one, one.query()) for one in packages]
    try:
        with httpx.Client(base_url=service, timeout=TIMEOUT_S) as client:
            for _ in range(PAGES):
                questions = list(_answered(client, questions, looked.found))
                if not questions:
                    return looked
    except (httpx.HTTPError, httpx.InvalidURL) as error:
        raise CouldNotLook(f"{service}: {error or type(error).__name__}") from error
    except MALFORMED as error:
        raise CouldNotLook(f"{service}: not an answer of OSV: {error}") from error
    raise CouldNotLook(f"{service}: more than {PAGES} pages for {questions[0][0]}")


Question = tuple[Package, dict[str, Any]]


def _answered(
    client: httpx.Client, questions: Sequence[Question], found: dict[Package, set[str]]
) -> Iterator[Question]:
    """Ask all of them and note what is found; what has a further page comes back with its token."""
    for start in range(0, len(questions), BATCH):
        batch = questions[start : start + BATCH]
        asked = {"queries": [query for _, query in batch]}
        results = json.loads(_answer(client, asked))["results"]
        if len(results) != len(batch):
            raise ValueError(f"{len(results)} results for {len(batch)} packages")
        for (package, query), result in zip(batch, results, strict=True):
            known = {one["id"] for one in result.get("vulns", ())}
            if not all(map(IDENTIFIER.fullmatch, known)):
                raise ValueError("an id that names no vulnerability")
            if known:
                found.setdefault(package, set()).update(known)
            if token := result.get("next_page_token"):
                yield package, query | {"page_token": token}


def say(line: str) -> None:
    """Print one line: what somebody else named may neither break it nor steer the terminal."""
    sys.stdout.write("".join(one if one.isprintable() else "?" for one in line) + "\n")


def _answer(client: httpx.Client, asked: object) -> bytes:
    """All of one answer, if it comes in time and is no larger than one may be."""
    end_s, said = time.monotonic() + TIMEOUT_S, bytearray()
    with client.stream("POST", "/v1/querybatch", json=asked) as reply:
        reply.raise_for_status()
        for chunk in reply.iter_bytes(1 << 16):
            said += chunk
            if len(said) > MOST_BYTES or time.monotonic() > end_s:
                raise ValueError(f"more than {MOST_BYTES >> 20} MiB, or {TIMEOUT_S:.0f} s")
    return bytes(said)


def tell(looked: Looked, contents: Contents, source: str) -> int:
    """Print what is known, what was looked at, and what was not."""
    found, unknown = looked.found, [*contents.unknown, *looked.unknown]
    for package in sorted(found):
        places = ", ".join(sorted(contents.where[package]))
        say(f"{package} ({places}): {' '.join(sorted(found[package]))}")
    numbers: set[str] = set().union(*found.values())
    age = f", whose newest entry is of {looked.newest[:10]}" if looked.newest else ""
    say(
        f"looked at {len(contents.where)} packages, by {source}{age}: {len(numbers)} entries "
        f"of {len(found)} of them"
    )
    if contents.unfollowed:
        count = len(contents.unfollowed)
        sys.stdout.write(
            f"not looked at: {count} packages of ROS 2 and EdgeVox, nobody lists them\n"
        )
    for one in unknown:
        say(f"could not look: {one}")
    if found:
        return FOUND
    return BLIND if unknown else CLEAN


if __name__ == "__main__":
    sys.exit(main())
