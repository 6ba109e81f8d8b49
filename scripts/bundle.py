"""Make one archive that a site without a network installs (docs/updates.md): `make bundle KEY=...`.

In it are an image, models, the chart, compose files, the documents, bills of materials, provenance,
a checksum of each file, and the site's signature of those. One commit, image and Ed25519 key give
the same bytes each time.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from provenance import SBOM_IN_IMAGE, Image, Source, provenance, sha256

from edgevox.core.errors import EdgeVoxError
from edgevox.models import Store

ROOT = Path(__file__).resolve().parent.parent
TAKEN = (  # of what git tracks
    *(".env", "docker-compose.ros2.yml", "compose", "systemd", "helm", "scenarios", "LICENSE"),
    *("CHANGELOG.md", "docs/*.md", "docs/*.json", ":!compose/dev.yml"),
)
PROGRAM = "scripts/install_bundle"
SUMS, SIGNATURE, NAMESPACE = "SHA256SUMS", "SHA256SUMS.sig", "edgevox-bundle"
PLAIN_NAME = re.compile(r"[\w.+/-]+", re.ASCII)
"""What names a checksum file and tar's listings write without quotes."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Make it and print its path; 1 and a line if it cannot be made."""
    parser = argparse.ArgumentParser("bundle.py", description=__doc__)
    parser.add_argument(
        "--key", required=True, help="private key of the site, or the public one of an agent's"
    )
    parser.add_argument("--image", default="edgevox-ros2:local")
    parser.add_argument(
        "--models", nargs="*", default=[], metavar="SET|ID", help="models apart from the image"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "bundle")
    options = parser.parse_args(arguments)
    try:
        made = make(options.key, options.image, options.models, options.out)
        sys.stdout.write(f"{made}\n")
    except (EdgeVoxError, OSError) as error:
        sys.stderr.write(f"bundle: {error}\n")
    except subprocess.CalledProcessError as error:
        said = (
            error.stderr.decode(errors="replace").strip()
            if error.stderr
            else f"exit code {error.returncode}"
        )
        sys.stderr.write(f"bundle: {error.cmd[0]}: {said}\n")
    else:
        return 0
    return 1


def make(key: str, image_name: str, models: Sequence[str], out: Path) -> Path:
    """Everything into a folder, then the folder into an archive.

    Raises `EdgeVoxError`, `OSError`, `CalledProcessError`.
    """
    source, image = Source.of(ROOT), Image.named(image_name)
    if image.revision != source.commit or source.changed:
        made = f"{image.name} was made from {image.revision or 'an unknown commit'}"
        sys.stderr.write(f"bundle: {made}, the rest is {source}; provenance.json says so\n")
    out.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=out, prefix=".bundle-") as bench:
        folder = Path(bench, "bundle")
        copy_tracked(folder)
        stamp_chart(folder / "helm" / "edgevox" / "Chart.yaml", image.version)
        shutil.copy(ROOT / PROGRAM, folder / "install")
        save_image(image, folder, Path(bench), source.date)
        copy_models(models, folder)
        about = provenance(source, image, models, ROOT)
        (folder / "provenance.json").write_text(
            json.dumps(about, indent=1) + "\n", encoding="utf-8"
        )
        made = datetime.fromtimestamp(source.date, UTC)
        (folder / "bundle.date").write_text(f"{made:%Y-%m-%dT%H:%M:%SZ}\n", encoding="utf-8")
        write_sums(folder)
        sign(folder / SUMS, key)
        unfinished = Path(bench, "bundle.tar")
        pack(folder, unfinished, source.date)
        archive = out / f"edgevox-{image.tag}-{image.architecture}.tar"
        return unfinished.replace(archive)


def copy_tracked(folder: Path) -> None:
    """The files that a site runs and reads, as they are in the working tree."""
    command = ["git", "ls-files", "-z", "--", *TAKEN]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in listed.rstrip("\0").split("\0"):
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, place)


def stamp_chart(file: Path, version: str) -> None:
    """Write the image's version into the chart; the chart's own one in semantic versioning."""
    semantic = re.sub(r"\.dev(\d+)", r"-dev.\1", version)
    text = re.sub(
        r"^version: .*$", f"version: {semantic}", file.read_text("utf-8"), flags=re.MULTILINE
    )
    text = re.sub(r"^appVersion: .*$", f'appVersion: "{version}"', text, flags=re.MULTILINE)
    file.write_text(text, encoding="utf-8")


def save_image(image: Image, folder: Path, bench: Path, date: int) -> None:
    """The image, by a name of its own so that loading it takes no other's away, and its SBOM."""
    with image.tagged() as reference:
        (folder / "image.name").write_text(f"{reference}\n", encoding="utf-8")
        saved = bench / "saved.tar"
        subprocess.run(
            ["docker", "save", "--output", saved, reference], check=True, capture_output=True
        )
    same = bench / "image.tar"
    with tarfile.open(saved) as read, tarfile.open(same, "w") as written:
        for member in sorted(read.getmembers(), key=lambda one: one.name):
            member.mtime = date
            written.addfile(member, read.extractfile(member) if member.isfile() else None)
    saved.unlink()
    if zstd := shutil.which("zstd"):  # docker load and k3s read it by themselves
        command = [zstd, "--quiet", "-T2", "--rm", same, "-o", folder / "image.tar.zst"]
        subprocess.run(command, check=True, capture_output=True)
    else:
        same.rename(folder / "image.tar")
    (folder / "sbom").mkdir()
    (folder / "sbom" / "image.json").write_bytes(image.read(SBOM_IN_IMAGE))


def copy_models(names: Sequence[str], folder: Path) -> None:
    """Models of this machine, each byte hashed anew, and their bill of materials."""
    if not names:
        return
    store = Store()
    for model in store.manifest.select(names):
        if wrong := store.verify(model):
            listed = ", ".join(file.name for file in wrong)
            raise FileNotFoundError(
                f"{model.id}: not here or damaged: {listed}; edgevox-models fetch {model.id}"
            )
        for file in model.files:
            place = folder / "models" / model.id / file.name
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(store.folder(model) / file.name, place)
    command = [sys.executable, ROOT / "docker" / "write_sbom", "--models", folder / "models"]
    listed_models = subprocess.run(command, check=True, capture_output=True).stdout
    (folder / "sbom" / "models.json").write_bytes(listed_models)


def files_of(folder: Path) -> list[str]:
    """The names of all files, sorted. Raises `OSError` for one that would need quotes."""
    names = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    if odd := [name for name in names if not PLAIN_NAME.fullmatch(name)]:
        raise OSError(f"a name with other characters than letters, digits and ._+/-: {odd[0]!r}")
    return names


def write_sums(folder: Path) -> None:
    """A line for each file, as sha256sum writes and checks it."""
    lines = [f"{sha256(folder / name)}  {name}\n" for name in files_of(folder)]
    (folder / SUMS).write_text("".join(lines), encoding="utf-8")


def sign(file: Path, key: str) -> None:
    """The signature beside it. The key may be in an agent or on a token, as ssh-keygen has it."""
    command = ["ssh-keygen", "-q", "-Y", "sign", "-n", NAMESPACE, "-f", key, file]
    subprocess.run(command, check=True, stdin=sys.stdin)


def pack(folder: Path, archive: Path, date: int) -> None:
    """Only files, in one order, of one time and of nobody; what is verified first comes first."""
    first = {SUMS: 0, SIGNATURE: 1}
    with tarfile.open(archive, "w", format=tarfile.GNU_FORMAT) as written:
        for name in sorted(files_of(folder), key=lambda one: (first.get(one, 2), one)):
            member = written.gettarinfo(folder / name, arcname=name)
            member.uid = member.gid = 0
            member.uname = member.gname = ""
            member.mtime = date
            member.mode = 0o755 if member.mode & 0o100 else 0o644
            with (folder / name).open("rb") as stream:
                written.addfile(member, stream)


if __name__ == "__main__":
    sys.exit(main())
