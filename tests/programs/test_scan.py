"""The scan for known vulnerabilities, against a service that answers as OSV does, or does not."""

import io
import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout, suppress
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any

import pytest
from guards import HUNG_S
from models_sources import CLOSED, serving

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))

from scan import main

ROOT = Path(__file__).resolve().parents[2]
ANSWERS = Path(__file__).with_name("osv_answers.json")
"""What is known of a package by ecosystem, name and version, in the form that OSV documents."""
OPENSSL = "pkg:deb/debian/libssl3@3.0.9-1?arch=amd64&distro=debian-12&upstream=openssl%403.0.9-1"
PILLOW = "pkg:pypi/Pillow@9.0.0"


class Osv:
    """A service with those answers; `pages` splits each into several."""

    def __init__(self, pages: bool = False) -> None:
        self.asked: list[dict[str, Any]] = []
        self._known: Mapping[str, Any] = json.loads(ANSWERS.read_text())
        self._pages = pages

    def answer(self, queries: list[dict[str, Any]]) -> dict[str, Any]:
        self.asked += queries
        return {"results": [self._one(query) for query in queries]}

    def _one(self, query: dict[str, Any]) -> dict[str, Any]:
        package = query["package"]
        vulns = self._known.get(f"{package['ecosystem']} {package['name']} {query['version']}", [])
        if not self._pages or not vulns:
            return {"vulns": vulns} if vulns else {}
        at = int(query.get("page_token", 0))
        more = {"next_page_token": str(at + 1)} if at + 1 < len(vulns) else {}
        return {"vulns": vulns[at : at + 1], **more}


def handler(answer: Any) -> type[BaseHTTPRequestHandler]:
    """Answers each question with what `answer` makes of its queries; with a number, that status."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            said = answer(asked["queries"]) if callable(answer) else answer
            body = json.dumps(said).encode() if isinstance(said, dict) else str(said).encode()
            right = self.path == "/v1/querybatch" and not isinstance(said, int)
            self.send_response(200 if right else said if isinstance(said, int) else 404)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None: ...

    return Handler


@pytest.fixture
def osv() -> Iterator[tuple[Osv, str]]:
    service = Osv()
    with serving(handler(service.answer)) as address:
        yield service, address


def sbom(folder: Path, *purls: str) -> Path:
    """A bill of materials with these packages."""
    path = folder / "sbom.json"
    components = [{"type": "library", "name": one, "purl": one} for one in purls]
    path.write_text(json.dumps({"bomFormat": "CycloneDX", "components": components}))
    return path


def scan(service: str, *more: str | Path) -> tuple[int, str]:
    with redirect_stdout(io.StringIO()) as said, redirect_stderr(io.StringIO()) as wrong:
        code = main(["--service", service, *map(str, more)])
    assert not wrong.getvalue()
    return code, said.getvalue()


def test_what_is_known_is_told_with_where_it_is(osv: tuple[Osv, str], tmp_path: Path) -> None:
    more = ("--service", osv[1], "--sbom", sbom(tmp_path, PILLOW, OPENSSL))
    command = [sys.executable, ROOT / "scripts" / "scan.py", *more]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S, cwd=ROOT)
    code, said = ran.returncode, ran.stdout

    assert (code, ran.stderr) == (1, "")
    first, second = said.splitlines()[:2]
    assert first == f"Debian:12 openssl 3.0.9-1 ({tmp_path}/sbom.json): DEBIAN-CVE-2023-5363"
    assert second == f"PyPI pillow 9.0.0 ({tmp_path}/sbom.json): GHSA-8vj2-vxx3-667w PYSEC-2022-10"
    assert "3 entries of 2 of them\n" in said
    assert "could not look" not in said


def test_every_package_of_every_lock_is_asked_of(osv: tuple[Osv, str], tmp_path: Path) -> None:
    service, address = osv
    code, said = scan(address, "--sbom", sbom(tmp_path))

    assert code == 0, said
    asked = {(one["package"]["name"], one["version"]) for one in service.asked}
    page = json.loads((ROOT / "requirements" / "page" / "package-lock.json").read_text())
    named = {path.removeprefix("node_modules/"): one for path, one in page["packages"].items()}
    assert {(name, one["version"]) for name, one in named.items() if name} <= asked
    for lock in (ROOT / "requirements").glob("*.lock"):
        pinned = (line.split()[0] for line in lock.read_text().splitlines() if "==" in line)
        for name, _, version in (one.lower().partition("==") for one in pinned):
            assert name.startswith("ros-") or (name, version) in asked, (lock.name, name)
    assert f"looked at {len(asked)} packages" in said
    assert "0 entries of 0 of them\n" in said
    assert not [name for name, _ in asked if name.startswith("ros-")]
    assert "packages of ROS 2 and EdgeVox, nobody lists them" in said


def test_a_python_package_is_asked_of_once_however_it_is_spelt(
    osv: tuple[Osv, str], tmp_path: Path
) -> None:
    service, address = osv
    spelt = ("Some.Name", "some_name", "some-name")
    scan(address, "--sbom", sbom(tmp_path, *(f"pkg:pypi/{name}@1" for name in spelt)))

    asked = [one for one in service.asked if one["package"]["name"].startswith("some")]
    assert asked == [{"package": {"ecosystem": "PyPI", "name": "some-name"}, "version": "1"}]


def test_an_answer_in_several_pages_is_read_to_its_end(tmp_path: Path) -> None:
    with serving(handler(Osv(pages=True).answer)) as address:
        code, said = scan(address, "--sbom", sbom(tmp_path, PILLOW))

    assert code == 1
    assert "GHSA-8vj2-vxx3-667w PYSEC-2022-10\n" in said


def refused(code: int, said: str, *words: str) -> None:
    """It could not look, says so, and says nothing of a number."""
    assert code == 3
    assert said.startswith("could not look: ")
    assert all(word in said for word in words)
    assert "entries" not in said


def test_without_a_service_it_says_that_it_could_not_look(tmp_path: Path) -> None:
    refused(*scan(CLOSED, "--sbom", sbom(tmp_path)), CLOSED)


@pytest.mark.parametrize(
    "answer",
    [
        *(503, {"results": []}, {"error": "no"}, {"results": None}, "<html>sign in</html>"),
        "[" * 200_000,
        lambda queries: {"results": [{"vulns": [{"id": 7}]} for _ in queries]},
        lambda queries: {"results": [{"vulns": [{"id": "A\n0 entries of 0"}]} for _ in queries]},
    ],
)
def test_what_is_no_whole_answer_is_none(tmp_path: Path, answer: object) -> None:
    with serving(handler(answer)) as address:
        refused(*scan(address, "--sbom", sbom(tmp_path)), address)


def test_an_answer_without_an_end_is_not_waited_for(tmp_path: Path) -> None:
    class Endless(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.send_response(200)
            self.end_headers()
            with suppress(OSError):
                while True:
                    self.wfile.write(b" " * (1 << 20))

        def log_message(self, *_: object) -> None: ...

    with serving(Endless) as address:
        refused(*scan(address, "--sbom", sbom(tmp_path)), "more than 64 MiB")


@pytest.mark.parametrize(
    "text", ["[]", '{"components": 1}', '{"components": [1]}', '{"components": [{"purl": 1}]}',
             '{"components": [{"type": "library"}]}', "[" * 200_000]
)  # fmt: skip
def test_what_is_no_bill_of_materials_is_not_counted_as_clean(
    osv: tuple[Osv, str], tmp_path: Path, text: str
) -> None:
    (tmp_path / "sbom.json").write_text(text)
    code, said = scan(osv[1], "--sbom", tmp_path / "sbom.json")

    assert code == 3
    assert "could not look: " in said.splitlines()[-1]
    assert "no bill of materials" in said


def test_a_packages_name_writes_no_line_of_its_own(tmp_path: Path) -> None:
    known = lambda queries: {"results": [{"vulns": [{"id": "CVE-1"}]} for _ in queries]}  # noqa: E731
    with serving(handler(known)) as address:
        _, said = scan(address, "--sbom", sbom(tmp_path, "pkg:pypi/a@1%0A%1B[2Jlooked"))

    (line,) = (one for one in said.splitlines() if one.startswith("PyPI a "))
    assert line == f"PyPI a 1??[2Jlooked ({tmp_path}/sbom.json): CVE-1"


def test_pages_without_an_end_are_no_answer(tmp_path: Path) -> None:
    def endless(queries: list[dict[str, Any]]) -> dict[str, Any]:
        return {"results": [{"next_page_token": "again"} for _ in queries]}

    with serving(handler(endless)) as address:
        refused(*scan(address, "--sbom", sbom(tmp_path)), "pages")


@pytest.mark.parametrize(
    "purl",
    ["pkg:deb/debian/bash@5?arch=amd64", "pkg:deb/other/bash@5?distro=other-1&upstream=bash%405"],
)
def test_a_package_of_an_unknown_release_is_not_counted_as_clean(
    osv: tuple[Osv, str], tmp_path: Path, purl: str
) -> None:
    code, said = scan(osv[1], "--sbom", sbom(tmp_path, purl))

    assert code == 3
    assert said.splitlines()[-1].startswith("could not look: 1 packages, ")
    assert said.endswith(f": {purl}\n")


def test_packages_of_ros_2_are_not_asked_about(osv: tuple[Osv, str], tmp_path: Path) -> None:
    service, address = osv
    code, _ = scan(address, "--sbom", sbom(tmp_path, "pkg:generic/ros/rclpy@7.1.5"))
    assert code == 0
    assert all(one["package"]["name"] != "rclpy" for one in service.asked)


def test_an_image_that_is_not_there_is_not_counted_as_clean(osv: tuple[Osv, str]) -> None:
    code, said = scan(osv[1], "--sbom", "/not/there.json")

    assert code == 3
    assert "could not look: /not/there.json: no bill of materials" in said


def test_ubuntus_and_debians_releases_are_called_as_osv_calls_them(
    osv: tuple[Osv, str], tmp_path: Path
) -> None:
    service, address = osv
    purls = [
        f"pkg:deb/x/libc6@2?distro={one}&upstream=glibc%402.1-3%2Bb1"
        for one in ("ubuntu-24.04", "ubuntu-24.10", "debian-13")
    ]
    scan(address, "--sbom", sbom(tmp_path, *purls))

    ours = ("PyPI", "npm")
    asked = [one for one in service.asked if one["package"]["ecosystem"] not in ours]
    assert sorted(one["package"]["ecosystem"] for one in asked) == [
        "Debian:13",
        "Ubuntu:24.04:LTS",
        "Ubuntu:24.10",
    ]
    assert {(one["package"]["name"], one["version"]) for one in asked} == {("glibc", "2.1-3+b1")}
