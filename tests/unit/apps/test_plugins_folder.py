"""Packages from a folder that is named: found, checked, told of, and never in the way."""

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from importlib.metadata import entry_points, version
from pathlib import Path

import pytest

from edgevox.apps.agent.main import main
from edgevox.apps.container import prepared
from edgevox.apps.plugins import SourceFinder, bring_plugins, plugins_folder
from edgevox.apps.robots import ROBOTS, learn_robots
from edgevox.core.errors import InvalidValue
from edgevox.robots.plugin import GROUP

EXAMPLES = Path(__file__).parents[3] / "examples"
MODULE = "from edgevox.robots.plugin import Robot\nROBOT = Robot('{}', lambda *_: None)\n"


@pytest.fixture(autouse=True)
def _as_before(monkeypatch):
    """What a plug-in puts into this process is gone after the test."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(sys, "meta_path", list(sys.meta_path))
    monkeypatch.setattr(sys, "path_importer_cache", dict(sys.path_importer_cache))
    SourceFinder.installed().packages.clear()
    for name, known in vars(ROBOTS).items():
        monkeypatch.setattr(ROBOTS, name, dict(known))


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "plugins"
    made.mkdir()
    return made


def files_of(name, needs=()):
    about = f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n"
    about += "".join(f"Requires-Dist: {need}\n" for need in needs)
    return {
        f"{name}.py": MODULE.format(name),
        f"{name}-1.2.dist-info/METADATA": about,
        f"{name}-1.2.dist-info/entry_points.txt": f"[{GROUP}]\nrobot-{name} = {name}:ROBOT\n",
    }


def wheel(folder, name, tag="py3-none-any", needs=()):
    file = folder / f"{name}-1.2-{tag}.whl"
    with zipfile.ZipFile(file, "w") as archive:
        for path, text in files_of(name, needs).items():
            archive.writestr(path, text)
    return file


def unpacked(folder, name):
    for path, text in files_of(name).items():
        file = folder / name / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)


def write_hashes(folder):
    files = [one for one in folder.rglob("*") if one.is_file()]
    lines = [
        f"{hashlib.sha256(one.read_bytes()).hexdigest()}  ./{one.relative_to(folder)}\n"
        for one in files
    ]
    (folder / "plugins.sha256").write_text("".join(lines))


def loaded(plugins):
    return [(one.name, one.version) for one in plugins.loaded]


def robot_of(name):
    (point,) = (one for one in entry_points(group=GROUP) if one.name == f"robot-{name}")
    return point.load()


@pytest.mark.parametrize("put", [wheel, unpacked])
def test_a_wheel_or_what_pip_makes_of_one_brings_its_robot(folder, put):
    name = f"brought_by_{put.__name__}"
    put(folder, name)
    before = sorted(folder.rglob("*"))
    plugins = bring_plugins(folder)
    assert loaded(plugins) == [(name, "1.2")]
    assert version(name) == "1.2"
    learn_robots()
    assert ROBOTS[f"robot-{name}"].about == name
    assert [one for one in sorted(folder.rglob("*")) if "__pycache__" not in str(one)] == before


def test_a_wheel_finds_its_data_beside_its_modules_and_leaves_nothing_behind(folder, tmp_path):
    with zipfile.ZipFile(wheel(folder, "with_data"), "a") as archive:
        archive.writestr("data_of_it/words.txt", "what it says")
        archive.writestr(
            "data_of_it/__init__.py",
            "from pathlib import Path\nSAID = (Path(__file__).parent / 'words.txt').read_text()\n",
        )
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    code = (
        "import sys; from pathlib import Path; from edgevox.apps.plugins import bring_plugins;"
        "bring_plugins(Path(sys.argv[1])); import data_of_it; print(data_of_it.SAID)"
    )
    ran = subprocess.run(
        [sys.executable, "-c", code, str(folder)],
        env={**os.environ, "TMPDIR": str(scratch)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert ran.stdout == "what it says\n"
    assert list(scratch.iterdir()) == []


def test_a_packages_own_folder_is_taken_as_it_is(folder):
    shutil.copytree(EXAMPLES / "own_robot", folder / "shuttle")
    plugins = bring_plugins(folder)
    assert plugins.broken == {}
    assert loaded(plugins) == [("edgevox-shuttle", "1.0")]
    assert robot_of("shuttle").about


def test_without_a_folder_nothing_is_brought(monkeypatch):
    monkeypatch.delenv("EDGEVOX_PLUGINS", raising=False)
    before = list(sys.path)
    assert bring_plugins(plugins_folder(["robot-external"])).loaded == ()
    assert sys.path == before


def test_a_folder_that_is_not_there_is_told_by_its_setting(tmp_path, capsys):
    with pytest.raises(InvalidValue, match="^plugins: got '.*/nope', expected a folder"):
        bring_plugins(tmp_path / "nope")
    assert main(["robot-external", "--plugins", str(tmp_path / "nope")]) == 2
    assert "plugins: got" in capsys.readouterr().err


def test_a_broken_one_is_told_by_name_and_the_others_are_there(folder):
    (folder / "broken-1.0-py3-none-any.whl").write_text("no archive")
    (folder / "notes.txt").write_text("?")
    (folder / "empty").mkdir()
    (folder / "nameless").mkdir()
    (folder / "nameless" / "pyproject.toml").write_text("[project]\nversion = '1'\n")
    (folder / "torn").mkdir()
    (folder / "torn" / "pyproject.toml").write_text("[project\n")
    wheel(folder, "compiled_one", "cp312-cp312-linux_x86_64")
    wheel(folder, "needy_one", needs=["no-such-package>=2", "numpy", "other; extra == 'x'"])
    wheel(folder, "well_one")
    plugins = bring_plugins(folder)
    assert loaded(plugins) == [("well_one", "1.2")]
    assert plugins.broken.keys() == {
        "broken-1.0-py3-none-any.whl",
        "compiled_one-1.2-cp312-cp312-linux_x86_64.whl",
        "empty",
        "nameless",
        "needy_one-1.2-py3-none-any.whl",
        "notes.txt",
        "torn",
    }
    needy = plugins.broken["needy_one-1.2-py3-none-any.whl"]
    assert "needs no-such-package: " in needy
    assert "project.name" in plugins.broken["nameless"]


def test_one_whose_files_cannot_be_read_hides_no_other_package(folder):
    about = f"[project]\nname = 'p'\n[project.entry-points.'{GROUP}']\n'a\\nb' = 'x:y'\n"
    (folder / "lines").mkdir()
    (folder / "lines" / "pyproject.toml").write_text(about.replace("'a\\nb'", '"a\\nb"'))
    for name, about in {"binary": b"\xff\xfe", "pointless": b"Name: q\nVersion: 1\n\n"}.items():
        info = folder / name / f"{name}-1.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_bytes(about)
        (info / "entry_points.txt").write_text(f"[{GROUP}]\nno point\n")
    (folder / "pipe" / "pipe-1.dist-info").mkdir(parents=True)
    os.mkfifo(folder / "pipe" / "pipe-1.dist-info" / "METADATA")
    locked = wheel(folder, "locked_one")
    data = bytearray(locked.read_bytes())
    for mark, flags in ((b"PK\1\2", 8), (b"PK\3\4", 6)):  # says that it is encrypted
        at = data.find(mark)
        while at >= 0:
            data[at + flags] |= 1
            at = data.find(mark, at + 1)
    locked.write_bytes(data)
    wheel(folder, "open_one")
    plugins = bring_plugins(folder)
    assert plugins.broken.keys() == {"binary", "lines", locked.name, "pipe", "pointless"}
    assert loaded(plugins) == [("open_one", "1.2")]
    assert robot_of("open_one")


def test_it_takes_the_place_of_nothing_that_is_installed(folder):
    for name in ("edgevox", "yaml"):
        place = folder / name
        place.mkdir()
        (place / "pyproject.toml").write_text(f"[project]\nname = '{name}'\nversion = '99'\n")
        (place / name).mkdir()
        (place / name / "__init__.py").write_text("")
    bring_plugins(folder)
    for name in ("edgevox", "yaml"):
        assert not importlib.util.find_spec(name).origin.startswith(str(folder))


def test_with_hashes_everything_is_as_they_say(folder):
    wheel(folder, "hashed_one")
    unpacked(folder, "hashed_two")
    write_hashes(folder)
    assert loaded(bring_plugins(folder)) == [("hashed_one", "1.2"), ("hashed_two", "1.2")]


def change(folder):
    (folder / "guarded" / "guarded.py").write_text("import os")


def add(folder):
    (folder / "guarded" / "more.py").write_text("")


def take_away(folder):
    (folder / "guarded" / "guarded.py").unlink()


def misspell(folder):
    (folder / "plugins.sha256").write_text("abc guarded\n")


def lead_nowhere(folder):
    (folder / "plugins.sha256").unlink()
    (folder / "plugins.sha256").symlink_to("nowhere")


def link_to_itself(folder):
    for name in ("a", "b"):
        (folder / "guarded" / name).symlink_to(".")


@pytest.mark.parametrize(
    ("tamper", "said"),
    [
        (lead_nowhere, "plugins.sha256: got .* a file that can be read"),
        (link_to_itself, "plugins: guarded/[ab]: got .* each folder once"),
        (change, r"plugins: guarded/guarded.py: got '\w+…\w+', expected [0-9a-f]{64}, as "),
        (change, "as plugins.sha256 says"),
        (add, "plugins: guarded/more.py: got .* no file that plugins.sha256 does not name"),
        (take_away, "plugins: guarded/guarded.py: got .* the file that plugins.sha256 names"),
        (misspell, "plugins.sha256: line 1: got 'abc guarded', expected a SHA-256"),
    ],
)
def test_with_hashes_nothing_is_loaded_if_anything_is_not_as_they_say(folder, tamper, said):
    unpacked(folder, "guarded")
    wheel(folder, "beside")
    write_hashes(folder)
    tamper(folder)
    before = list(sys.path)
    with pytest.raises(InvalidValue, match=said.replace("…", ".*")):
        bring_plugins(folder)
    assert sys.path == before


def test_the_folder_comes_from_a_flag_a_variable_or_the_settings_file(tmp_path, monkeypatch):
    config = tmp_path / "edgevox.toml"
    config.write_text('plugins = "/of/file"\n')
    of_file = ["robot-external", "--config", str(config), "--ros2"]
    monkeypatch.delenv("EDGEVOX_PLUGINS", raising=False)
    assert plugins_folder(of_file) == Path("/of/file")
    monkeypatch.setenv("EDGEVOX_PLUGINS", "/of/variable")
    assert plugins_folder(of_file) == Path("/of/variable")
    assert plugins_folder([*of_file, "--plugins=/of/flag"]) == Path("/of/flag")


def test_who_asks_for_a_robot_that_a_broken_one_should_have_brought_is_told_why(folder, capsys):
    (folder / "mine-1.0-py3-none-any.whl").write_text("no archive")
    with pytest.raises(SystemExit):
        main(["robot-mine", "--plugins", str(folder)])
    assert "mine-1.0-py3-none-any.whl" in capsys.readouterr().err


def test_the_container_knows_a_plug_ins_robot_and_is_told_what_is_broken(folder):
    wheel(folder, "in_container")
    (folder / "notes.txt").write_text("?")
    said = []
    given = {"EDGEVOX_PLUGINS": str(folder), "EDGEVOX_AGENT": "robot-in_container"}
    environment = prepared(given, said.append)
    assert environment["EDGEVOX_AGENT"] == "robot-in_container"
    assert [line.split(":")[1] for line in said] == [" notes.txt"]
    with pytest.raises(InvalidValue, match="EDGEVOX_PLUGINS: got '/nope', expected a folder"):
        prepared({"EDGEVOX_PLUGINS": "/nope"}, said.append)
