"""What is in the image, what is not, and that all of it works as nobody on a read-only disk."""

import json
import re
import struct
import subprocess
import tomllib
from pathlib import Path

import pytest
from guards import HUNG_S, run_program

from edgevox import __version__

ROOT = Path(__file__).resolve().parents[2]
LOCKED_DOWN = (
    *("--rm", "--read-only", "--tmpfs=/tmp:mode=1777,exec", "--network=none"),
    *("--cap-drop=ALL", "--security-opt=no-new-privileges"),
)
LIMITS = {"edgevox": 2.0e9, "slim": 0.7e9}
"""Bytes that a target may have on the stand-in base."""
COMPILERS = ("cc", "c++", "gcc", "g++", "clang", "cpp", "make", "cmake", "ninja", "rustc", "go")
SECRETS = r"BEGIN [A-Z ]*PRIVATE KEY|\b(AKIA[0-9A-Z]{16}|gh[pousr]_\w{36}|hf_\w{34})\b"
NO_KEY = "/site-packages/cryptography/hazmat/primitives/serialization/ssh.py"
"""How the first line of a key is spelt is a constant there."""
SPEAK = """
from edgevox.voice.tts.kokoro import Phonemes
import kokoro_onnx, faster_whisper, piper, xllamacpp, numpy
assert numpy.__version__.startswith("1.26."), numpy.__version__
print(len(Phonemes().tokens("Ni hao, the robot speaks.", "af_bella")))
print(len(Phonemes().tokens("\\u4f60\\u597d\\uff0c\\u4e16\\u754c", "zf_xiaobei")))
"""


@pytest.fixture(scope="module")
def inside(image):
    """Runs a command in the image, locked down; its output."""

    def run(*command: str, options: tuple[str, ...] = (), stdin: str = "") -> str:
        ran = run_program(
            ["docker", "run", "--interactive", *LOCKED_DOWN, *options, image, *command], input=stdin
        )
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout

    return run


@pytest.fixture(scope="module")
def found(image):
    """What a search of the image's whole file system as root prints, line by line."""

    def search(script: str) -> list[str]:
        command = ["docker", "run", "--rm", "--user=0", "--entrypoint=bash", image, "-c", script]
        ran = subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S)
        return ran.stdout.split("\n")[:-1]

    return search


@pytest.fixture(scope="module")
def about(image):
    """What the engine knows of the image."""
    ran = subprocess.run(
        ["docker", "image", "inspect", image], capture_output=True, text=True, check=True
    )
    return json.loads(ran.stdout)[0]


def test_it_runs_as_edgevox_with_no_rights_at_all(inside, about):
    assert about["Config"]["User"] == "1000:1000"
    said = inside("bash", "-c", "id -un; grep CapEff /proc/self/status; touch /x 2>&1 || true")
    assert said.splitlines()[0] == "edgevox"
    assert said.splitlines()[1].split() == ["CapEff:", "0000000000000000"]
    assert "Read-only file system" in said


def test_any_other_uid_will_do_as_well(inside):
    said = inside("edgevox-agent", "--version", options=("--user=4321:4321",))
    assert re.search(r"\d+\.\d+\.\d+", said)


def test_no_program_runs_as_somebody_else_than_who_starts_it(found):
    assert not found("find / -xdev -type f -perm /6000")


def test_nobody_can_write_what_all_can_read(found):
    """But for the sticky folders for temporary files."""
    search = r"find / -xdev \( -path /proc -o -path /sys -o -path /dev \) -prune -o "
    assert not found(search + r"-type f -perm -0002 -print")
    assert not found(search + r"-type d -perm -0002 ! -perm -1000 -print")
    assert not found(r"find /opt -xdev ! -user root -print")


def test_there_is_no_secret_in_it(found, about, image):
    assert not found(r"ls -d /run/secrets/* /root/.netrc /root/.ssh /root/.config 2>/dev/null")
    named = found(rf"grep -rlIE '{SECRETS}' /opt/edgevox /etc /root /home 2>/dev/null")
    assert [file for file in named if not file.endswith(NO_KEY)] == []
    assert not found(f"grep -hE '^[[:space:]]*-+BEGIN' /opt/edgevox/lib/python*{NO_KEY}")
    history = subprocess.run(
        ["docker", "history", "--no-trunc", "--format={{.CreatedBy}}", image],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    for text in (history, json.dumps(about["Config"]["Env"])):
        assert not re.search(r"(?i)token=|password=|secret=[^ ]|_key=", text)


def test_there_is_no_compiler_and_no_cache_in_it(found):
    names = " ".join(COMPILERS)
    assert not found(f"PATH=$PATH:/tools/bin; for name in {names}; do command -v $name; done")
    assert not found(r"find / -xdev \( -name cc1 -o -name cc1plus -o -name rust-lld \) -print")
    assert not found("ls -A /root/.cache /var/lib/apt/lists/*_Packages 2>/dev/null")
    assert not found("find /var/cache/apt -name '*.deb' -o -name 'pkgcache.bin'")
    assert not found("ls -d /tools /src /wheel /given /cache 2>/dev/null")


def test_it_is_as_small_as_promised(about, image):
    assert about["Size"] < LIMITS["edgevox"]
    slim = run_program(["docker", "image", "inspect", "--format={{.Size}}", f"{image}-slim"])
    assert slim.returncode == 0, f"there is no {image}-slim: run make image"
    assert int(slim.stdout) < LIMITS["slim"]


def test_it_says_what_it_is(about):
    labels = {name.rpartition(".")[2]: value for name, value in about["Config"]["Labels"].items()}
    assert {"title", "description", "licenses", "name", "documentation", "created"} <= set(labels)
    assert labels["version"] == __version__
    assert about["Config"]["Healthcheck"]["Test"][:2] == ["CMD", "edgevox-health"]
    assert about["Config"]["StopSignal"] == "SIGTERM"


def test_a_container_with_one_processor_computes_with_one_thread(inside):
    """Whatever the machine has: threads that are not paid for stop those that are."""
    asked = "from edgevox.agent.llm.weights import default_threads as threads; import os; "
    asked += "print(threads(), len(os.sched_getaffinity(0)), os.environ['OMP_NUM_THREADS'])"
    threads, cores, openmp = inside("python3", "-c", asked, options=("--cpus=1",)).split()
    assert (threads, openmp) == ("1", "1")
    assert int(cores) > 1, "this machine cannot show it"


def test_what_the_container_may_take_of_memory_is_known_in_it(inside):
    asked = "from edgevox.core.process import memory_left; print(memory_left())"
    left = int(inside("python3", "-c", asked, options=("--memory=256m",)))
    assert 100 << 20 < left < 256 << 20


def test_ros_2_and_the_interfaces_are_at_hand_for_every_python(inside):
    script = 'import rclpy, edgevox_msgs.action, tf2_msgs.msg; print("all here")'
    for python in ("python3", "/usr/bin/python3"):
        assert "all here" in inside("bash", "-c", f"{python} -c '{script}'")


def test_ros_2_finds_the_package_and_its_programs(inside):
    script = """
    prefix=/opt/edgevox
    for file in share/ament_index/resource_index/packages/edgevox share/edgevox/package.xml \
            share/edgevox/launch/edgevox.launch.py lib/edgevox/edgevox-agent; do
        [ -e $prefix/$file ] || echo "no $file"
    done
    $prefix/lib/edgevox/edgevox-agent --version
    """
    assert not re.search("^no ", inside("bash", "-c", script), re.MULTILINE)


@pytest.mark.parametrize("robot", ["robot-panda", "robot-humanoid"])
def test_a_robots_camera_sees_without_a_gpu(inside, robot):
    script = f"edgevox-agent {robot} --snapshot /tmp/x.png >&2 && base64 -w 0 /tmp/x.png"
    picture = subprocess.run(
        ["base64", "-d"], input=inside("bash", "-c", script).encode(), capture_output=True
    ).stdout
    assert picture[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", picture[16:24])
    assert min(width, height) >= 240
    assert len(picture) > 20_000  # a picture of one colour would be small


@pytest.mark.parametrize(
    ("robot", "scenario"),
    [
        ("robot-apartment", "apartment"),
        ("robot-irsim", "apartment"),
        ("robot-panda", "panda"),
        ("robot-humanoid", "humanoid"),
    ],
)
def test_every_robot_does_what_it_is_told(inside, robot, scenario):
    file = f"/opt/edgevox/scenarios/{scenario}.yaml"
    said = inside("edgevox-agent", robot, "--llm", "none", "--scenario", file)
    assert said.splitlines()[-1].startswith("PASSED")


def test_the_voices_read_with_the_bases_numpy(inside):
    counts = [int(line) for line in inside("python3", "-", stdin=SPEAK).split()]
    assert min(counts) >= 5


def test_its_models_are_whole_to_the_last_byte(inside):
    said = inside("edgevox-models", "verify", "small", "robots")
    assert said.strip()
    assert all(line.endswith(": right") for line in said.splitlines())


@pytest.fixture(scope="module")
def sbom(inside):
    document = json.loads(inside("cat", "/opt/edgevox/sbom.json"))
    assert document["bomFormat"] == "CycloneDX"
    return document


def test_the_bill_of_materials_names_every_python_package(sbom):
    named = {(one["name"].lower().replace("_", "-"), one["version"]) for one in pypi(sbom)}
    locked = set(re.findall(r"^([\w.-]+)==(\S+)", locked_text(), re.MULTILINE))
    assert ("numpy", "1.26.4") in named
    assert {(name.lower(), version) for name, version in locked} <= named
    assert "edgevox-robot" in {name for name, _ in named}


def locked_text() -> str:
    """The image's lock without what other systems and newer Pythons need."""
    lines = (ROOT / "requirements" / "image.lock").read_text().splitlines()
    return "\n".join(line for line in lines if ";" not in line)


def test_the_bill_of_materials_names_every_debian_package(sbom, found):
    listed = found(r"dpkg-query -W -f '${db:Status-Status} ${Package} ${Version}\n'")
    installed = {tuple(line.split()[1:]) for line in listed if line.startswith("installed")}
    named = {(one["name"], one["version"]) for one in of_kind(sbom, "pkg:deb/")}
    (plugin,) = named - installed  # of which only ALSA's way to a sound server was taken
    assert plugin[0] == "libasound2-plugins"
    assert installed < named
    assert len(named) > 50
    for one in of_kind(sbom, "pkg:deb/"):  # what a scan goes by
        assert re.search(r"&distro=(debian|ubuntu)-[\d.]+&upstream=[^&]+%40[^&]+$", one["purl"])


def test_the_bill_of_materials_names_every_package_of_ros_2_and_ours(sbom, found):
    here = r"find /opt/ros/*/share /opt/edgevox/ros/share -maxdepth 2 -name package.xml"
    named = {one["name"]: one for one in of_kind(sbom, "pkg:generic/ros/")}
    assert {Path(line).parent.name for line in found(here)} == set(named)
    assert {"rclpy", "std_msgs", "edgevox_msgs"} <= set(named)
    assert all(one["licenses"] and one["version"] for one in named.values())


def test_the_bill_of_materials_has_the_hash_of_each_locked_archive_and_nearly_all_licences(sbom):
    lock = (ROOT / "requirements" / "image.lock").read_text()
    locked = {
        name.lower() for name, _ in re.findall(r"^([\w.-]+)==(\S+)", locked_text(), re.MULTILINE)
    }
    hashes = {
        one["name"].lower().replace("_", "-"): one["hashes"][0]["content"]
        for one in pypi(sbom)
        if "hashes" in one
    }
    assert locked - set(hashes) == {"numpy"}, "the base's own"
    assert all(one in lock for one in hashes.values())
    libraries = [one for one in sbom["components"] if one["type"] == "library"]
    without = [one["name"] for one in libraries if not one["licenses"]]
    assert len(without) < 0.05 * len(libraries), without


def test_the_bill_of_materials_names_every_model_with_its_licence(sbom):
    folder = ROOT / "edgevox" / "models"
    sets: dict[str, list[str]] = {}
    for file in folder.glob("*.toml"):
        sets |= tomllib.loads(file.read_text()).get("sets", {})
    models = {
        one["name"]: one for one in sbom["components"] if one["type"] == "machine-learning-model"
    }
    assert set(models) == {*sets["small"], *sets["robots"]}
    for one in models.values():
        assert one["licenses"], one["name"]
        assert all(len(file["hashes"][0]["content"]) == 64 for file in one["components"])


def pypi(sbom: dict) -> list[dict]:
    return of_kind(sbom, "pkg:pypi/")


def of_kind(sbom: dict, prefix: str) -> list[dict]:
    return [one for one in sbom["components"] if one.get("purl", "").startswith(prefix)]
