"""A bundle is made of a tiny image, and installed or refused where there is no network at all."""

import fcntl
import gzip
import hashlib
import io
import json
import os
import re
import subprocess
import sys
import tarfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from shutil import which
from typing import Any

import pytest
import yaml
from guards import HUNG_S, run_program
from stacks import docker

from edgevox.models import Store

pytestmark = pytest.mark.long

ROOT = Path(__file__).resolve().parents[2]
BUNDLE = ROOT / "scripts" / "bundle.py"
INSTALL = ROOT / "scripts" / "install_bundle"
NAMESPACES = (
    ("unshare", "--net"),
    ("unshare", "--net", "--map-root-user"),
    ("sudo", "--non-interactive", "unshare", "--net"),
)
"""Ways to a network namespace of one's own: as root, as whoever may, as whoever may become root."""
MODEL = "micro-wake-words"
SOON = "2099-01-01T00:00:00Z"
Files = dict[str, bytes]


@cache
def no_network() -> tuple[str, ...]:
    """The first of those ways that this machine allows; without one there is nothing to test."""
    for way in NAMESPACES:
        if which(way[0]) and subprocess.run([*way, "true"], capture_output=True).returncode == 0:
            return way
    pytest.fail("nobody here may make a network namespace: be root, or have sudo", pytrace=False)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory, image) -> Iterator[str]:
    """An image with nothing but a bill of materials; `image` only says that an engine is there."""
    name = f"edgevox-test-tiny:{os.getpid()}"
    build(tmp_path_factory.mktemp("tiny"), name, "7.8.9.dev12")
    yield name
    docker("rmi", "--force", name)


def build(folder: Path, name: str, version: str) -> None:
    (folder / "sbom.json").write_text('{"bomFormat": "CycloneDX", "components": []}')
    (folder / "Dockerfile").write_text(
        f"FROM scratch\nCOPY sbom.json /opt/edgevox/sbom.json\nLABEL of={name}\n"
        f"LABEL org.opencontainers.image.version={version}\n"
    )
    docker("build", "--quiet", "--tag", name, str(folder))


@pytest.fixture(scope="module")
def keys(tmp_path_factory) -> Path:
    """A folder with two keys of a site, `site` and `other`, and their public halves."""
    folder = tmp_path_factory.mktemp("keys")
    for name in ("site", "other"):
        make = ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", name, "-f", folder / name]
        subprocess.run(make, check=True, timeout=HUNG_S)
    return folder


@pytest.fixture(scope="module")
def archive(tiny, keys, tmp_path_factory) -> Path:
    return made(tiny, keys / "site", tmp_path_factory.mktemp("made"))


def made(image: str, key: Path, out: Path, *more: str) -> Path:
    command = [sys.executable, BUNDLE, "--key", key, "--image", image, "--out", out, *more]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == f"{next(out.iterdir())}\n", "nothing else may be left there"
    return Path(ran.stdout.rstrip())


def compose_config(folder: Path) -> dict[str, Any]:
    """What compose would start in a folder, with nothing but what is there."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("COMPOSE", "EDGEVOX"))}
    command = ["docker", "compose", "--profile", "*", "config", "--format", "json"]
    ran = subprocess.run(command, cwd=folder, env=clean, capture_output=True, check=True)
    return json.loads(ran.stdout)


def installed(key: Path, archive: Path, folder: Path, *flags: str) -> tuple[int, str]:
    """What the program ended with, and said, in a namespace that has no network."""
    command = [*no_network(), INSTALL, *flags, key, archive, folder]
    ran = run_program(command)
    return ran.returncode, ran.stdout + ran.stderr


def image_name(archive: Path) -> str:
    with tarfile.open(archive) as read:
        return read.extractfile("image.name").read().decode().strip()


def contents(archive: Path) -> Files:
    with tarfile.open(archive) as read:
        return {one.name: read.extractfile(one).read() for one in read.getmembers()}


def written(files: Files, path: Path) -> Path:
    with tarfile.open(path, "w", format=tarfile.GNU_FORMAT) as archive:
        for name, data in files.items():
            add(archive, name, data)
    return path


def add(archive: tarfile.TarFile, name: str, data: bytes) -> None:
    member = tarfile.TarInfo(name)
    member.size = len(data)
    archive.addfile(member, io.BytesIO(data))


def loaded(name: str) -> bool:
    looked = subprocess.run(["docker", "image", "inspect", name], capture_output=True)
    return looked.returncode == 0


def test_its_name_its_image_and_its_chart_have_the_images_version(archive):
    assert archive.name.startswith("edgevox-7.8.9.dev12-")
    assert image_name(archive).startswith("edgevox-ros2:7.8.9.dev12-")
    chart = yaml.safe_load(contents(archive)["helm/edgevox/Chart.yaml"])
    assert (chart["version"], chart["appVersion"]) == ("7.8.9-dev.12", "7.8.9.dev12")


def test_there_is_no_network_where_it_is_installed():
    look = [*no_network(), "cat", "/proc/net/dev"]
    ran = subprocess.run(look, capture_output=True, text=True, check=True)
    assert re.findall(r"^ *(\S+):", ran.stdout, re.MULTILINE) == ["lo"]


def test_it_is_verified_and_loaded_without_a_network(archive, keys, tmp_path, tiny):
    name, place = image_name(archive), tmp_path / "site"
    identity = docker("image", "inspect", "--format={{.Id}}", tiny).strip()
    docker("rmi", tiny)
    try:
        code, said = installed(keys / "site.pub", archive, place)
        assert code == 0, said
        assert "\ndocker compose up" in said
        assert compose_config(place)["services"]["edgevox-ros2"]["image"] == identity
        assert docker("image", "inspect", "--format={{.Id}}", name).strip() == identity
    finally:
        docker("tag", name, tiny)
        docker("rmi", name)
    assert (place / "docker-compose.ros2.yml").read_text() == (
        ROOT / "docker-compose.ros2.yml"
    ).read_text()
    assert (place / "install").stat().st_mode & 0o7777 == 0o755
    assert (place / "image.name").stat().st_mode & 0o7777 == 0o644
    for needed in (".env", "helm/edgevox/Chart.yaml", "docs/updates.md", "sbom/image.json"):
        assert (place / needed).is_file(), needed


def test_what_was_unpacked_is_a_stack_that_compose_takes(archive, keys, tmp_path):
    code, said = installed(keys / "site.pub", archive, tmp_path / "site", "--no-load")
    assert (code, loaded(image_name(archive))) == (0, False), said
    for overlay in sorted((tmp_path / "site" / "compose").glob("*.yml")):
        files = ["-f", "docker-compose.ros2.yml", "-f", f"compose/{overlay.name}"]
        command = ["docker", "compose", *files, "--profile", "*", "config", "--quiet"]
        ran = subprocess.run(command, cwd=tmp_path / "site", capture_output=True, text=True)
        assert ran.returncode == 0, ran.stderr


def test_the_same_gives_the_same_bytes(archive, tiny, keys, tmp_path):
    again = made(tiny, keys / "site", tmp_path / "again")
    assert again.name == archive.name
    assert sha256(again.read_bytes()) == sha256(archive.read_bytes())


def test_models_apart_are_verified_and_started_from_a_volume_of_their_own(tiny, keys, tmp_path):
    path = made(tiny, keys / "site", tmp_path / "made", "--models", MODEL)
    listed = json.loads(contents(path)["sbom/models.json"])
    assert [one["name"] for one in listed["components"]] == [MODEL]
    code, said = installed(keys / "site.pub", path, tmp_path / "site")
    docker("rmi", image_name(path))
    assert code == 0, said
    told = compose_config(tmp_path / "site")
    assert re.fullmatch(r"edgevox_models_[0-9a-f]{12}", told["volumes"]["models"]["name"])
    assert MODEL in json.dumps(told["services"]["models"]["command"])
    assert "docker compose run --rm models &&\ndocker compose up" in said
    store = Store(tmp_path / "site" / "models")
    assert not store.verify(store.manifest.models[MODEL])


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def test_it_says_where_it_comes_from(archive, tiny):
    statement = json.loads(contents(archive)["provenance.json"])
    identity = docker("image", "inspect", "--format={{.Id}}", tiny).strip()
    assert statement["subject"][0]["digest"]["sha256"] == identity.removeprefix("sha256:")
    definition = statement["predicate"]["buildDefinition"]
    inputs = {one["name"]: one["digest"] for one in definition["resolvedDependencies"]}
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    assert inputs["source"] == {"gitCommit": head.stdout.strip()}
    for name in ("Dockerfile.ros2", "requirements/image.lock", "edgevox/models/manifest.toml"):
        assert inputs[name] == {"sha256": sha256((ROOT / name).read_bytes())}
    assert definition["internalParameters"]["image_is_of_this_source"] is False, "it has no label"


def changed_byte(files: Files) -> None:
    data = bytearray(files["docker-compose.ros2.yml"])
    data[len(data) // 2] ^= 1
    files["docker-compose.ros2.yml"] = bytes(data)


def changed_image(files: Files) -> None:
    (name,) = (one for one in files if one.startswith("image.tar"))
    files[name] += b"\0"


def missing_file(files: Files) -> None:
    del files["compose/policy.yml"]


def extra_file(files: Files) -> None:
    files["compose/more.yml"] = b"services: {}\n"


def file_outside(files: Files) -> None:
    files["../outside"] = b"x"


def other_sums(files: Files) -> None:
    """A changed file, and the checksum that goes with it."""
    files["install"] += b"\nid\n"
    line = re.compile(r"^[0-9a-f]{64}(?=  install$)", re.MULTILINE)
    sums = line.sub(sha256(files["install"]), files["SHA256SUMS"].decode())
    assert sums.encode() != files["SHA256SUMS"]
    files["SHA256SUMS"] = sums.encode()


def no_signature(files: Files) -> None:
    del files["SHA256SUMS.sig"]


@pytest.mark.parametrize(
    ("tamper", "reason"),
    [
        (changed_byte, "changed: docker-compose.ros2.yml"),
        (changed_image, "changed: image.tar"),
        (missing_file, "other files than signed: compose/policy.yml"),
        (extra_file, "other files than signed: compose/more.yml"),
        (file_outside, "other files than signed: ../outside"),
        (other_sums, "is not signed with"),
        (no_signature, "has no checksums with a signature"),
    ],
)
def test_one_that_is_not_as_it_was_signed_is_refused(
    archive, keys, tmp_path, tamper: Callable[[Files], None], reason
):
    files = contents(archive)
    tamper(files)
    refused(keys / "site.pub", written(files, tmp_path / "bad.tar"), tmp_path / "site", reason)


def refused(key: Path, archive: Path, folder: Path, reason: str) -> None:
    """With this reason, and nothing is left of it: no folder, no image."""
    code, said = installed(key, archive, folder)
    assert code == 1, said
    assert reason in said
    assert said.count("\n") == 1
    assert said.endswith("; nothing was installed\n")
    assert not any(path.suffix == ".part" for path in folder.parent.iterdir())
    assert not folder.exists()
    assert not (folder.parent / "outside").exists()
    assert not loaded(image_name(archive))


def test_one_that_another_key_signed_is_refused(archive, keys, tmp_path):
    refused(keys / "other.pub", archive, tmp_path / "site", "is not signed with")


def test_a_signature_of_the_site_for_something_else_is_refused(archive, keys, tmp_path):
    files = contents(archive)
    sums = tmp_path / "SHA256SUMS"
    sums.write_bytes(files["SHA256SUMS"])
    sign = ["ssh-keygen", "-q", "-Y", "sign", "-n", "file", "-f", keys / "site", sums]
    subprocess.run(sign, check=True, capture_output=True)
    files["SHA256SUMS.sig"] = (tmp_path / "SHA256SUMS.sig").read_bytes()
    refused(keys / "site.pub", written(files, tmp_path / "a.tar"), tmp_path / "b", "not signed")


@pytest.mark.parametrize("kind", [tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.FIFOTYPE])
def test_what_is_no_file_is_refused(archive, keys, tmp_path, kind):
    files = contents(archive)
    del files["LICENSE"]
    link = tarfile.TarInfo("LICENSE")
    link.type, link.linkname = kind, "CHANGELOG.md"
    path = written(files, tmp_path / "bad.tar")
    with tarfile.open(path, "a") as more:
        more.addfile(link)
    refused(keys / "site.pub", path, tmp_path / "site", "something that is not a file")


def test_a_file_that_is_there_twice_is_refused(archive, keys, tmp_path):
    path = written(contents(archive), tmp_path / "bad.tar")
    with tarfile.open(path, "a") as more:
        add(more, "install", b"#!/bin/sh\nid\n")
    refused(keys / "site.pub", path, tmp_path / "site", "other files than signed: install")


def swapped(bad: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From now on tar unpacks the bad one, as if it had taken the place of what was looked at."""
    folder.mkdir()
    tar = folder / "tar"
    command = (
        f'[ "$1" != -xf ] || {{ shift 2; set -- -xf "{bad}" "$@"; }}\nexec {which("tar")} "$@"\n'
    )
    tar.write_text(f"#!/bin/sh\n{command}")
    tar.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")


def more_file(bad: tarfile.TarFile, data: bytes) -> None:
    add(bad, "compose/more.yml", b"services: {}\n")
    add(bad, "LICENSE", data)


def link_outwards(bad: tarfile.TarFile, data: bytes) -> None:
    link = tarfile.TarInfo("LICENSE")
    link.type, link.linkname = tarfile.SYMTYPE, str(ROOT / "LICENSE")
    bad.addfile(link)


@pytest.mark.parametrize("swap", [more_file, link_outwards])
def test_what_takes_its_place_while_it_is_verified_is_refused(
    archive, keys, tmp_path, monkeypatch, swap: Callable[[tarfile.TarFile, bytes], None]
):
    files = contents(archive)
    data = files.pop("LICENSE")
    bad = written(files, tmp_path / "bad.tar")
    with tarfile.open(bad, "a") as more:
        swap(more, data)
    swapped(bad, tmp_path / "bin", monkeypatch)
    refused(keys / "site.pub", archive, tmp_path / "site", "changed while it was read")


def test_nobody_else_sees_what_is_not_verified_yet(archive, keys, tmp_path, monkeypatch):
    (tmp_path / "bin").mkdir()
    sums = tmp_path / "bin" / "sha256sum"
    command = f'stat -c %a . >"{tmp_path}/mode"\nexec {which("sha256sum")} "$@"\n'
    sums.write_text(f"#!/bin/sh\n{command}")
    sums.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}/bin:{os.environ['PATH']}")
    code, said = installed(keys / "site.pub", archive, tmp_path / "site", "--no-load")
    assert code == 0, said
    assert (tmp_path / "mode").read_text() == "700\n"
    assert (tmp_path / "site").stat().st_mode & 0o777 == 0o755


def test_a_name_cannot_write_lines_of_its_own_or_steer_the_terminal(archive, keys, tmp_path):
    files = contents(archive)
    files["a\nVerified: 90 files.\033[2J"] = b"x"
    bad = written(files, tmp_path / "bad.tar")
    code, said = installed(keys / "site.pub", bad, tmp_path / "site")
    assert code == 1
    assert said.count("\n") == 1
    assert said.rstrip("\n").isprintable()


def test_one_of_holes_that_would_fill_a_disk_is_refused_unread(archive, keys, tmp_path):
    files = contents(archive)
    del files["LICENSE"]
    bad = written(files, tmp_path / "bad.tar")
    with (tmp_path / "LICENSE").open("wb") as holes:
        holes.truncate(1 << 33)
    pack = ["tar", "--append", "--sparse", "-f", bad, "-C", tmp_path, "LICENSE"]
    subprocess.run(pack, check=True, timeout=HUNG_S)
    assert bad.stat().st_size < 2 * archive.stat().st_size
    refused(keys / "site.pub", bad, tmp_path / "site", "more than there is")


def test_one_that_is_compressed_is_given_to_no_program_that_reads_it(archive, keys, tmp_path):
    bad = tmp_path / "bad.tar"
    bad.write_bytes(gzip.compress(archive.read_bytes(), 1))
    refused(keys / "site.pub", bad, tmp_path / "site", "is no archive as `make bundle` makes it")


@pytest.mark.parametrize("name", ["x; touch pasted;'$(touch pasted)", "-x", "host:x"])
def test_an_archives_name_runs_nothing_not_even_where_its_last_words_are_pasted(
    archive, keys, tmp_path, name
):
    (tmp_path / f"{name}.tar").write_bytes(archive.read_bytes())
    command = [*no_network(), INSTALL, keys / "site.pub", f"{name}.tar"]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S, cwd=tmp_path)
    docker("rmi", image_name(archive))
    assert ran.returncode == 0, ran.stderr
    (pasted,) = (line for line in ran.stdout.splitlines() if line.startswith("cd "))
    there = subprocess.run(["sh", "-ec", f"{pasted}\npwd"], capture_output=True, text=True, cwd="/")
    assert there.stdout == f"{tmp_path / name}\n", there.stderr
    assert not (tmp_path / "pasted").exists()


def test_one_that_ends_too_early_is_refused(archive, keys, tmp_path):
    data = archive.read_bytes()
    (tmp_path / "short.tar").write_bytes(data[: len(data) // 2])
    code, said = installed(keys / "site.pub", tmp_path / "short.tar", tmp_path / "site")
    assert code == 1, said
    assert "nothing was installed" in said
    assert [path.name for path in tmp_path.iterdir()] == ["short.tar"]


def test_a_private_key_is_no_public_one(archive, keys, tmp_path):
    code, said = installed(keys / "site", archive, tmp_path / "site")
    assert code == 2
    assert "is no public key" in said


def signed_again(files: Files, keys: Path, path: Path, **more: bytes) -> Path:
    """The archive of these files, with others, as the site would sign them."""
    files = {name: data for name, data in files.items() if not name.startswith("SHA256SUMS")} | more
    sums = path.parent / "SHA256SUMS"
    sums.write_text("".join(f"{sha256(data)}  {name}\n" for name, data in sorted(files.items())))
    sign = ["ssh-keygen", "-q", "-Y", "sign", "-f", keys / "site", "-n", "edgevox-bundle", sums]
    sums.with_suffix(".sig").unlink(missing_ok=True)
    subprocess.run(sign, check=True, capture_output=True)
    signature = (path.parent / "SHA256SUMS.sig").read_bytes()
    return written(files | {"SHA256SUMS": sums.read_bytes(), "SHA256SUMS.sig": signature}, path)


def dated(archive: Path, keys: Path, path: Path, date: str) -> Path:
    return signed_again(contents(archive), keys, path, **{"bundle.date": f"{date}\n".encode()})


def install_without_loading(key: Path, archive: Path, folder: Path, *more: str) -> tuple[int, str]:
    return installed(key, archive, folder, "--no-load", *more)


def test_an_older_one_is_refused_unless_that_is_asked_for(archive, keys, tmp_path):
    key, robot = keys / "site.pub", tmp_path / "robot"
    newer = dated(archive, keys, tmp_path / "newer.tar", SOON)
    assert install_without_loading(key, newer, robot / "newer")[0] == 0

    code, said = install_without_loading(key, archive, robot / "older")
    assert (code, said.count("\n")) == (1, 1)
    assert f"is older than the last one, of {SOON}" in said
    assert sorted(one.name for one in robot.iterdir()) == [".edgevox-bundle", "newer"]

    assert install_without_loading(key, archive, robot / "older", "--allow-downgrade")[0] == 0
    assert install_without_loading(key, newer, robot / "newer")[0] == 0, "and forward again"


def test_the_previous_folder_goes_on_starting_the_previous_image(archive, keys, tmp_path, tiny):
    """The runbook's way back, also where its image was pruned, and its settings were left alone."""
    key, robot, later = keys / "site.pub", tmp_path / "robot", f"{tiny}-later"
    (tmp_path / "later").mkdir()
    build(tmp_path / "later", later, "7.8.9.dev13")
    update = dated(
        made(later, keys / "site", tmp_path / "out"), keys, tmp_path / "update.tar", SOON
    )

    def started(folder: str) -> str:
        told = compose_config(robot / folder)["services"]["edgevox-ros2"]
        assert told["environment"]["ROS_DOMAIN_ID"] == "7"
        return told["image"]

    try:
        assert installed(key, archive, robot / "old")[0] == 0
        old = docker("image", "inspect", "--format={{.Id}}", image_name(archive)).strip()
        with (robot / "old" / ".env").open("a") as env:
            env.write("ROS_DOMAIN_ID=7\n")
        assert installed(key, update, robot / "new")[0] == 0
        new = docker("image", "inspect", "--format={{.Id}}", image_name(update)).strip()
        assert old != new
        assert (started("old"), started("new")) == (old, new)

        docker("rmi", "--force", old)
        assert not loaded(old)
        code, said = installed(key, archive, robot / "old", "--allow-downgrade")
        assert code == 0, said
        assert loaded(old)
        assert (started("old"), started("new")) == (old, new)
    finally:
        docker("tag", image_name(archive), tiny)
        docker("rmi", "--force", image_name(archive), image_name(update), later)


def test_a_site_that_installs_twice_has_what_it_had(archive, keys, tmp_path):
    key, place = keys / "site.pub", tmp_path / "robot" / "one"
    assert install_without_loading(key, archive, place)[0] == 0
    with (place / ".env").open("a") as env:
        env.write("ROS_DOMAIN_ID=7\n")
    (place / "policy.yaml").write_text("mine")

    code, said = install_without_loading(key, archive, place)

    assert (code, "Verified" in said) == (0, True), said
    assert (place / ".env").read_text().endswith("ROS_DOMAIN_ID=7\n")
    assert (place / "policy.yaml").read_text() == "mine"


def test_the_sites_settings_and_files_are_copied_to_the_next_ones_folder(archive, keys, tmp_path):
    key, robot = keys / "site.pub", tmp_path / "robot"
    assert install_without_loading(key, archive, robot / "one")[0] == 0
    one = robot / "one"
    (one / ".env").write_text(
        "COMPOSE_FILE=docker-compose.ros2.yml:compose/host.yml\nROS_DOMAIN_ID=7\n"
        "# <install>\nEDGEVOX_IMAGE=sha256:old\n# </install>\nEDGEVOX_LANGUAGE=fr\n"
    )
    (one / "site" / "robot").mkdir(parents=True)
    (one / "site" / "robot" / "robot.yaml").write_text("mine")
    (one / "compose" / "robot.yml").write_text("edited")
    newer = dated(archive, keys, tmp_path / "newer.tar", SOON)

    code, said = install_without_loading(key, newer, robot / "two")

    assert code == 0, said
    assert "not copied, though edited in" in said
    assert "compose/robot.yml" in said
    assert (robot / "two" / "site" / "robot" / "robot.yaml").read_text() == "mine"
    assert (robot / "two" / "compose" / "robot.yml").read_text() != "edited"
    assert (robot / "two" / ".env").read_text() == (ROOT / ".env").read_text() + (
        "COMPOSE_FILE=docker-compose.ros2.yml:compose/host.yml\n"
        "ROS_DOMAIN_ID=7\nEDGEVOX_LANGUAGE=fr\n"
    )


def test_what_a_killed_one_left_is_no_obstacle(archive, keys, tmp_path):
    (tmp_path / "site.part").mkdir()
    (tmp_path / "site.part" / "image.tar").write_text("half")
    assert install_without_loading(keys / "site.pub", archive, tmp_path / "site")[0] == 0
    assert not (tmp_path / "site.part").exists()


def test_a_disk_without_room_is_said_in_one_line(archive, keys, tmp_path, monkeypatch):
    (tmp_path / "df").write_text("#!/bin/sh\necho a\necho 'b 9 9 1024 9% /'\n")
    (tmp_path / "df").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")

    code, said = install_without_loading(keys / "site.pub", archive, tmp_path / "x" / "site")

    assert (code, said.count("\n")) == (1, 1)
    assert "has 1 MB left, and 6" in said
    assert not (tmp_path / "x" / "site").exists()


def test_two_at_once_do_not_meet(archive, keys, tmp_path):
    held = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    code, said = install_without_loading(keys / "site.pub", archive, tmp_path / "site")
    os.close(held)
    assert code == 2
    assert "another install works in" in said


def test_what_is_there_already_is_left_alone(archive, keys, tmp_path):
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "mine").write_text("mine")
    code, said = installed(keys / "site.pub", archive, tmp_path / "site")
    assert code == 2
    assert "is there already" in said
    assert (tmp_path / "site" / "mine").read_text() == "mine"


def test_an_image_without_a_bill_of_materials_is_not_bundled(keys, tmp_path, tiny):
    (tmp_path / "Dockerfile").write_text("FROM scratch\nCOPY Dockerfile /Dockerfile\n")
    name = f"{tiny}-bare"
    docker("build", "--quiet", "--tag", name, str(tmp_path))
    try:
        command = [sys.executable, BUNDLE, "--key", keys / "site", "--image", name]
        ran = run_program([*command, "--out", tmp_path / "out"])
    finally:
        docker("rmi", name)
    assert ran.returncode == 1
    assert "/opt/edgevox/sbom.json" in ran.stderr
    assert not list((tmp_path / "out").iterdir())
