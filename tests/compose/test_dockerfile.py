"""What can be known of the image's build without the official base, which is not pulled here."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from guards import HUNG_S, run_program

ROOT = Path(__file__).resolve().parents[2]
DOCKERFILES = ("Dockerfile.ros2", "docker/base/Dockerfile")
FILES = (path for path in (ROOT / "docker").rglob("*") if path.is_file())
SCRIPTS = sorted(path for path in FILES if path.read_bytes().startswith(b"#!"))
OFFICIAL = "ros:jazzy-ros-base"
ARM64 = {
    "tools": ("aarch64-manylinux_2_39", "3.12", 5),
    "slim": ("aarch64-manylinux_2_39", "3.12", 70),
    "image": ("aarch64-manylinux_2_39", "3.12", 90),
    "run": ("aarch64-manylinux_2_35", "3.11", 90),
}
"""What is installed there, by lock: on which glibc, which Python, at least how many packages.

The image's are those of Ubuntu 24.04, below the official image; `run` is `make run`.
"""
SOURCES = {"jieba"}
"""Packages that have no wheel for any machine; plain Python, so that no compiler is needed."""


def instructions(name: str) -> list[str]:
    """A Dockerfile's instructions: no comments, continued lines joined."""
    lines = [line for line in (ROOT / name).open() if not line.lstrip().startswith("#")]
    return re.sub(r"\\\n", "", "".join(lines)).splitlines()


def stage(name: str, label: str) -> list[str]:
    """The instructions of one stage."""
    body: list[str] = []
    inside = False
    for line in instructions(name):
        if line.startswith("FROM "):
            inside = line.endswith(f" AS {label}")
        elif inside and line:
            body.append(line)
    return body


@pytest.mark.parametrize("name", DOCKERFILES)
def test_hadolint_finds_nothing(name):
    hadolint = Path(sys.executable).with_name("hadolint")
    ran = subprocess.run([hadolint, name], cwd=ROOT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr


@pytest.mark.parametrize("name", DOCKERFILES)
def test_nothing_is_pulled_or_downloaded_besides_the_base(name):
    text = (ROOT / name).read_text()
    assert not re.search(r"^#\s*syntax\s*=", text, re.MULTILINE)
    assert not [line for line in instructions(name) if line.startswith("ADD ")]
    assert "curl" not in text
    assert "wget" not in text


def test_the_official_image_is_the_base_unless_one_says_otherwise():
    assert f"ARG ROS_IMAGE={OFFICIAL}" in instructions("Dockerfile.ros2")
    bases = {line.split()[1] for line in instructions("Dockerfile.ros2") if line[:5] == "FROM "}
    labels = {line.split()[-1] for line in instructions("Dockerfile.ros2") if line[:5] == "FROM "}
    assert bases - labels == {"${ROS_IMAGE}", "scratch"}


def test_the_image_has_the_small_models_and_all_robots_unless_one_says_otherwise():
    assert 'ARG MODEL_SET="small robots"' in stage("Dockerfile.ros2", "fetched")


@pytest.mark.parametrize("target", ["slim", "edgevox"])
def test_code_comes_after_all_that_changes_less(target):
    copies = [line for line in stage("Dockerfile.ros2", target) if line.startswith("COPY")]
    assert copies[-1] == "COPY --from=code /code /"
    assert len(copies) > 1


@pytest.mark.parametrize("target", ["slim", "edgevox"])
def test_the_user_is_a_number_so_that_kubernetes_can_tell_it_from_root(target):
    assert stage("Dockerfile.ros2", target)[-1] == "USER ${EDGEVOX_UID}:${EDGEVOX_GID}"
    arguments = [line for line in stage("Dockerfile.ros2", "runtime") if line.startswith("ARG")]
    assert {"ARG EDGEVOX_UID=1000", "ARG EDGEVOX_GID=1000"} <= set(arguments)


def test_python_packages_are_installed_by_hash_only():
    """Except EdgeVox itself, without an index."""
    runs = [line for name in DOCKERFILES for line in instructions(name) if "pip" in line]
    installing = [line for line in runs if re.search(r"pip\b[^&;]* install|pip wheel", line)]
    assert len(installing) >= 4
    for line in installing:
        assert "--require-hashes" in line or "--no-index" in line, line
    for script in SCRIPTS:
        text = script.read_text().replace("\\\n", " ")
        for line in re.findall(r".*-m pip install.*", text):
            assert "--require-hashes" in line, script


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_scripts_of_the_build_are_sound(script):
    if "python" in script.read_text().splitlines()[0]:
        compile(script.read_text(), script, "exec")
    else:
        subprocess.run(["bash", "-n", script], check=True)


def test_what_others_make_is_named_by_its_hash():
    """Actions by commit, images by digest: a tag may be moved."""
    workflows = [*(ROOT / ".github").rglob("*.yml"), *(ROOT / "examples").rglob("*.yml")]
    texts = {path: path.read_text() for path in (*workflows, *(ROOT / "compose").glob("*.yml"))}
    used = {
        one: path
        for path, text in texts.items()
        for one in re.findall(r"^ +(?:- )?(?:uses|image): *\"?([^\s\"]+)", text, re.MULTILINE)
        if "EDGEVOX_IMAGE" not in one
    }
    assert len(used) > 8
    by_tag = {one for one in used if not re.search(r"@(sha256:[0-9a-f]{64}\}?|[0-9a-f]{40})$", one)}
    assert not by_tag


def test_the_labels_say_of_which_source_and_base_an_image_is():
    given = {"VERSION": "1.2.3", "REVISION": "abc", "CREATED": "2026-11-29T00:00:00Z"}
    given |= {"SOURCE": "https://git/edgevox", "BASE_DIGEST": "sha256:1"}
    for target in baked(**given).values():
        labels = {name.partition("image.")[2]: one for name, one in target["labels"].items()}
        assert labels == {
            "version": "1.2.3",
            "revision": "abc",
            "created": "2026-11-29T00:00:00Z",
            "source": "https://git/edgevox",
            "base.digest": "sha256:1",
        }


def test_both_architectures_are_defined():
    targets = baked(PLATFORMS="linux/amd64,linux/arm64")
    assert set(targets) == {"edgevox", "slim"}
    for name, target in targets.items():
        assert target["platforms"] == ["linux/amd64", "linux/arm64"]
        assert target["target"] == name
        assert target["args"]["ROS_IMAGE"] == OFFICIAL


def test_the_definition_has_the_same_defaults_as_the_dockerfile():
    (given,) = re.findall(r'ARG MODEL_SET="(.*)"', "\n".join(instructions("Dockerfile.ros2")))
    assert baked()["edgevox"]["args"]["MODEL_SET"] == given


def locked(name: str) -> dict[str, str]:
    """The requirements of a lock, each with its hashes, by package."""
    text = (ROOT / "requirements" / f"{name}.lock").read_text()
    return {
        one.partition("==")[0]: one for one in re.split(r"^(?=[a-z])", text, flags=re.MULTILINE)[1:]
    }


def test_the_slim_image_installs_nothing_that_the_other_does_not():
    assert locked("slim").items() <= locked("image").items()


@pytest.mark.parametrize("lock", ARM64)
def test_every_package_has_a_wheel_for_arm64_whose_hash_is_locked(tmp_path, lock):
    """Asks the index, of which only this list is asked; nothing is fetched."""
    platform, python, many = ARM64[lock]
    wheels = [text for name, text in locked(lock).items() if name not in SOURCES]
    (tmp_path / "arm64.lock").write_text("".join(wheels))
    command = [Path(sys.executable).with_name("uv"), "pip", "install", "--dry-run", "--no-deps"]
    command += ["--only-binary=:all:", "--require-hashes", "--python-platform", platform]
    command += ["--python-version", python, "--target", tmp_path / "nowhere"]
    command += ["--requirement", tmp_path / "arm64.lock"]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S)
    assert ran.returncode == 0, ran.stderr
    assert ran.stderr.count("\n + ") > many


def baked(**variables: str) -> dict:
    """The targets that docker/bake.hcl describes."""
    command = ["docker", "buildx", "bake", "-f", "docker/bake.hcl", "--print", "all"]
    environment = {"PATH": "/usr/local/bin:/usr/bin:/bin", "HOME": str(Path.home()), **variables}
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)["target"]


# What the official image does and the stand-in must do too: the build is tested on the latter only.
@pytest.fixture(scope="module")
def inside_base():
    """Runs a command in the stand-in."""

    def run(command: str, *, sourced: bool = True) -> str:
        options = [] if sourced else ["--entrypoint="]
        ran = run_program(
            ["docker", "run", "--rm", *options, "edgevox-base:local", "bash", "-c", command]
        )
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout.strip()

    return run


def test_the_stand_in_has_a_user_of_uid_1000_already(inside_base):
    assert inside_base("getent passwd 1000").startswith("ubuntu:x:1000:1000:")


def test_the_stand_in_forbids_pip_in_the_systems_python(inside_base):
    assert inside_base("ls /usr/lib/python3*/EXTERNALLY-MANAGED")


def test_the_stand_in_has_ros_2_by_sourcing_only(inside_base):
    importing = 'python3 -c "import rclpy; print(rclpy.__file__)"'
    assert inside_base(importing).startswith("/opt/ros/jazzy/lib/python3")
    assert inside_base(f"{importing} 2>&1 || true", sourced=False).endswith("'rclpy'")
    sourcing = f"source /opt/ros/jazzy/setup.bash -- && {importing}"
    assert inside_base(sourcing, sourced=False).startswith("/opt/ros/jazzy/lib/python3")


def test_the_stand_in_has_numpy_1_26_from_the_system(inside_base):
    about = 'python3 -c "import numpy; print(numpy.__version__, numpy.__file__)"'
    assert inside_base(about) == "1.26.4 /usr/lib/python3/dist-packages/numpy/__init__.py"


def test_only_ros_2s_own_packages_come_before_those_of_other_environments(inside_base):
    listed = inside_base("ls /opt/ros/jazzy/lib/python3*/site-packages").split()
    assert "rclpy" in listed
    assert not {"numpy", "yaml", "pip", "setuptools", "lark", "packaging"} & set(listed)
