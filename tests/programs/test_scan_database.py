"""The scan without a network: by entries of OSV that a site brought, made here in its form."""

import io
import json
import sys
import zipfile
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))

import osv_database
from scan import main

SYSTEMS = ("PyPI", "npm", "Debian:12", "Ubuntu:24.04:LTS")


def entry(number: str, ecosystem: str, name: str, *events: dict[str, str], **more: Any) -> Any:
    """An entry with one range, or with what `more` says in its place."""
    package = {"ecosystem": ecosystem, "name": name}
    kind = "SEMVER" if ecosystem == "npm" else "ECOSYSTEM"
    ranges = [{"type": kind, "events": list(events)}] if events else []
    about = {"package": package, "ranges": ranges, "versions": more.pop("versions", [])}
    modified = more.pop("modified", "2026-11-01T00:00:00Z")
    return {"id": number, "modified": modified, "affected": [about], **more}


def zipped(path: Path, *entries: Any) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, one in enumerate(entries):
            text = one if isinstance(one, bytes) else json.dumps(one)
            archive.writestr(f"{number}.json", text)
    return path


NOTHING = [
    entry(f"NOT-{at}", one, "not-ours", {"introduced": "0"}) for at, one in enumerate(SYSTEMS)
]
"""So that the database has entries of each ecosystem that the locks need."""


def scan(folder: Path, database: Path, *purls: str) -> tuple[int, str]:
    sbom = folder / "sbom.json"
    components = [{"type": "library", "name": one, "purl": one} for one in purls]
    sbom.write_text(json.dumps({"components": components}))
    with redirect_stdout(io.StringIO()) as said:
        code = main(["--db", str(database), "--sbom", str(sbom)])
    return code, said.getvalue()


def test_a_database_is_looked_into_without_a_service(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("httpx.Client", None)
    fixed = ({"introduced": "0"}, {"fixed": "2.0.10"})
    newest = "2026-11-28T10:00:00Z"
    database = zipped(
        tmp_path / "all.zip",
        *NOTHING,
        entry("GHSA-1", "PyPI", "Some.Name", *fixed, modified=newest),
        entry("GHSA-2", "PyPI", "some-name", *fixed, withdrawn="2026-01-01T00:00:00Z"),
        entry("GHSA-3", "npm", "some-name", {"introduced": "0"}),
        entry("GHSA-4", "PyPI", "some-name", {"introduced": "3"}),
    )
    code, said = scan(tmp_path, database, "pkg:pypi/some_name@2.0.9")

    assert code == 1
    first, *_, last = said.splitlines()
    assert first == f"PyPI some-name 2.0.9 ({tmp_path}/sbom.json): GHSA-1"
    assert f"by {database}, whose newest entry is of 2026-11-28: 1 entries of 1 of them" in said
    assert "could not look" not in last
    code, said = scan(tmp_path, database, "pkg:pypi/some_name@2.0.10")
    assert code == 0, said


def test_a_folder_holds_entries_and_archives(tmp_path: Path) -> None:
    database = tmp_path / "osv"
    (database / "PyPI").mkdir(parents=True)
    zipped(database / "rest.zip", *NOTHING)
    one = entry("PYSEC-1", "PyPI", "pillow", versions=["9.0"])
    (database / "PyPI" / "PYSEC-1.json").write_text(json.dumps(one))
    code, said = scan(tmp_path, database, "pkg:pypi/Pillow@9.0.0")

    assert code == 1
    assert said.startswith("PyPI pillow 9.0.0 ")
    assert "PYSEC-1\n" in said


def test_a_folder_as_osv_publishes_it_is_read_with_all_that_its_entries_tell(
    tmp_path: Path,
) -> None:
    """One archive for each ecosystem, and every field of OSV's schema, also those of no use."""
    commits = {"type": "GIT", "repo": "https://git/one", "events": [{"introduced": "0"}]}
    whole = entry("PYSEC-2026-1", "PyPI", "one", {"introduced": "0"}, {"last_affected": "1.1"})
    whole |= {
        "schema_version": "1.7.0",
        "published": "2026-01-01T00:00:00Z",
        "modified": "2026-11-02T03:04:05.678901Z",
        "aliases": ["CVE-2026-1", "GHSA-aaaa-bbbb-cccc"],
        "upstream": [],
        "related": [],
        "summary": "one",
        "details": "# one",
        "severity": [{"type": "CVSS_V3", "score": "CVSS:3.1/AV:N"}],
        "references": [{"type": "WEB", "url": "https://one"}],
        "credits": [{"name": "one", "type": "FINDER"}],
        "database_specific": {"source": "https://one"},
    }
    (about,) = whole["affected"]
    about["package"]["purl"] = "pkg:pypi/one"
    about["ranges"].insert(0, commits)
    about |= {"ecosystem_specific": {"severity": "LOW"}, "database_specific": {"cwes": []}}
    of_git_alone = {"id": "OSV-2026-1", "modified": "", "affected": [{"ranges": [commits]}]}
    for number, archive in enumerate(("PyPI", "npm", "Debian", "Ubuntu")):
        (tmp_path / "osv" / archive).mkdir(parents=True)
        more = [whole, of_git_alone] if archive == "PyPI" else []
        zipped(tmp_path / "osv" / archive / "all.zip", NOTHING[number], *more)
    code, said = scan(tmp_path, tmp_path / "osv", "pkg:pypi/one@1.1.0", "pkg:pypi/one@1.2")

    assert code == 1
    assert "could not look" not in said
    assert [line for line in said.splitlines() if "PYSEC" in line] == [
        f"PyPI one 1.1.0 ({tmp_path}/sbom.json): PYSEC-2026-1"
    ]


BOUNDED = ({"introduced": "1.2"}, {"fixed": "1.10"}, {"introduced": "2.0rc1"}, {"fixed": "2.1"})
LAST = ({"introduced": "1.0"}, {"last_affected": "1.0"})
LIMITED = ({"introduced": "0"}, {"limit": "1.5"})


@pytest.mark.parametrize(
    ("ecosystem", "events", "inside", "outside"),
    [
        ("PyPI", BOUNDED, ("1.2", "1.9.post1", "2.0rc1", "2.1.dev1"), ("1.1", "1.10", "2.1")),
        ("PyPI", tuple(reversed(BOUNDED)), ("1.2", "2.0"), ("1.2rc1", "2.0b2", "1!1.2")),
        ("PyPI", LAST, ("1.0", "1.0.0"), ("0.9", "1.0.post1", "1.1")),
        ("PyPI", LIMITED, ("0.1", "1.4"), ("1.5", "2")),
        ("npm", ({"introduced": "1.0.0-beta.2"}, {"fixed": "1.10.0"}),
         ("1.0.0-beta.11", "1.0.0-rc", "1.9.9", "1.10.0-0"),
         ("1.0.0-beta.1", "1.0.0-alpha", "1.10.0")),
        ("Debian:12", ({"introduced": "0"}, {"fixed": "3.0.9-1+deb12u2"}),
         ("3.0.9-1", "3.0.9-1+deb12u1", "3.0.9~rc1-5", "3.0.8-9", "3.0.9-1+deb12u2~1"),
         ("3.0.9-1+deb12u2", "3.0.9-1+deb12u10", "3.0.10-1", "1:0.1-1", "3.0.9a-1")),
        ("Ubuntu:24.04:LTS", ({"introduced": "0"}, {"fixed": "2.39-0ubuntu8.4"}),
         ("2.39-0ubuntu8.3",), ("2.39-0ubuntu8.4", "2.39-0ubuntu8.10")),
        ("Debian", ({"introduced": "0"}, {"fixed": "2"}), ("1.9",), ("2",)),
        ("Ubuntu:Pro:24.04:LTS", ({"introduced": "0"}, {"fixed": "1.2-3ubuntu0.1~esm1"}),
         ("1.2-3", "1.2-2ubuntu9"), ("1.2-3ubuntu0.1~esm1", "1.2-3ubuntu0.1")),
    ],
)  # fmt: skip
def test_ranges_are_read_as_the_schema_of_osv_says(
    tmp_path: Path,
    ecosystem: str,
    events: tuple[dict[str, str], ...],
    inside: tuple[str, ...],
    outside: tuple[str, ...],
) -> None:
    database = zipped(tmp_path / "all.zip", entry("CVE-1", ecosystem, "one", *events))
    asked = {"Debian": "Debian:12", "Ubuntu:Pro:24.04:LTS": "Ubuntu:24.04:LTS"}.get(
        ecosystem, ecosystem
    )
    packages = [osv_database.Package(asked, "one", version) for version in (*inside, *outside)]
    looked = osv_database.look_up(packages, database)

    assert {one.version for one in looked.found} == set(inside)
    assert not looked.unknown


@pytest.mark.parametrize(
    ("one", "why"),
    [
        (entry("CVE-1", "PyPI", "one", {"introduced": "bulb"}), "no version of its ecosystem"),
        (entry("CVE-1", "PyPI", "one"), "its entry tells no versions"),
    ],
)
def test_what_cannot_be_compared_is_not_counted_as_clean(
    tmp_path: Path, one: Any, why: str
) -> None:
    code, said = scan(tmp_path, zipped(tmp_path / "a.zip", *NOTHING, one), "pkg:pypi/one@1")

    assert code == 3
    assert f"could not look: PyPI one 1, CVE-1: {why}" in said


def test_an_ecosystem_without_entries_is_not_counted_as_clean(tmp_path: Path) -> None:
    database = zipped(tmp_path / "PyPI.zip", NOTHING[0])
    code, said = scan(tmp_path, database)

    assert code == 3
    assert said.splitlines()[-1] == f"could not look: {database} has no entries of npm"


@pytest.mark.parametrize(
    "text",
    [b"[]", b"{", b'{"id": "a b", "modified": ""}', b'{"id": "CVE-1"}', b"[" * 200_000,
     json.dumps(entry("CVE-1", "PyPI", "one", {"begun": "1"})).encode(),
     json.dumps({"id": "CVE-1", "modified": "", "affected": [7]}).encode()],
)  # fmt: skip
def test_what_is_no_entry_makes_it_no_database(tmp_path: Path, text: bytes) -> None:
    database = zipped(tmp_path / "all.zip", *NOTHING, text)
    code, said = scan(tmp_path, database, "pkg:pypi/one@1")

    assert code == 3
    assert said.startswith(f"could not look: {database}: 4.json: not an entry of OSV")
    assert "entries of" not in said


@pytest.mark.parametrize("name", ["all.zip", "none.zip", "folder"])
def test_what_cannot_be_read_is_no_database(tmp_path: Path, name: str) -> None:
    (tmp_path / "all.zip").write_bytes(b"PK not really")
    (tmp_path / "folder").mkdir()
    code, said = scan(tmp_path, tmp_path / name)

    assert code == 3
    assert said.startswith(f"could not look: {tmp_path / name}: ")


def test_one_that_unpacks_to_more_than_it_may_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    large = zipped(tmp_path / "all.zip", *NOTHING, b" " * 3_000_000)
    assert large.stat().st_size < 10_000
    monkeypatch.setattr(osv_database, "MOST_ENTRY_BYTES", 2 << 20)
    code, said = scan(tmp_path, large)
    assert (code, said.startswith(f"could not look: {large}: 4.json: more than 2 MiB")) == (3, True)
    monkeypatch.setattr(osv_database, "MOST_ENTRY_BYTES", 16 << 20)
    monkeypatch.setattr(osv_database, "MOST_BYTES", 2_000_000)
    code, said = scan(tmp_path, large)
    assert (code, said.startswith(f"could not look: {large}: 4.json: more than ")) == (3, True)
