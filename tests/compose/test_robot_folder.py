"""A robot of one's own in the container: by a folder, by plug-ins, by an image of one's own."""

import hashlib
import os
import secrets
import shutil
import subprocess

import pytest
import yaml
from guards import HUNG_S
from stacks import ROOT, docker, stack

pytestmark = pytest.mark.long

TEMPLATE = ROOT / "examples" / "robot_repository"
BUILD = "/src/docker/build_interfaces"
SPOT = ROOT / "examples" / "robot_file" / "spot"
SHUTTLE = ROOT / "examples" / "own_robot"
TMP = "/tmp:mode=1777"  # noqa: S108 - the container's
HARDENED = ("--read-only", "--cap-drop", "ALL", "--network", "none", "--tmpfs", TMP)
MOUNT = "/etc/edgevox/robot"


def run(image, *arguments, flags=()):
    """A container that is gone afterwards, as locked up as compose makes it."""
    command = ["docker", "run", "--rm", *HARDENED, *flags, image, *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S)


def mounted(folder, target="/plugins"):
    return ("--volume", f"{folder}:{target}:ro", "--env", "EDGEVOX_AGENT=robot-shuttle")


@pytest.fixture
def plugins(tmp_path):
    made = tmp_path / "plugins"
    shutil.copytree(SHUTTLE, made / "shuttle", ignore=shutil.ignore_patterns("__pycache__"))
    tmp_path.chmod(0o755)
    return made


@pytest.fixture
def derive(tmp_path):
    """Builds an image from a Dockerfile's text in the test's folder; it is gone afterwards."""
    made = []

    def build(dockerfile):
        (tmp_path / "Dockerfile").write_text(dockerfile)
        made.append(f"edgevox-test:{secrets.token_hex(4)}")
        docker("build", "--quiet", "--tag", made[-1], str(tmp_path))
        return made[-1]

    yield build
    for name in made:
        docker("image", "rm", "--force", name)


def test_a_scenario_of_the_folder_comes_true(image):
    folder = {"ROBOT_FOLDER": str(TEMPLATE / "robot")}
    with stack("robot", start=False, EDGEVOX_IMAGE=image, **folder) as one:
        scenario = ("--scenario", f"{MOUNT}/scenarios/errand.yaml", "--llm", "none")
        ran = one.call("run", "--rm", "-T", "edgevox-ros2", *scenario, timeout=HUNG_S)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        assert "errand.yaml on robot-apartment" in ran.stdout


@pytest.mark.parametrize(
    ("variable", "said"),
    [
        ("EDGEVOX_WORLD", "EDGEVOX_WORLD: got '/nope', expected a file"),
        ("EDGEVOX_POLICY", "EDGEVOX_POLICY: got '/nope', expected a file"),
        ("EDGEVOX_PLUGINS", "EDGEVOX_PLUGINS: got '/nope', expected a folder"),
        ("EDGEVOX_ROBOT_FOLDER", "EDGEVOX_ROBOT_FOLDER: got '/nope', expected a folder"),
    ],
)
def test_a_path_of_the_shell_that_is_not_there_ends_it_by_its_name(image, variable, said):
    with stack(start=False, EDGEVOX_IMAGE=image, **{variable: "/nope"}) as one:
        ran = one.call("run", "--rm", "-T", "edgevox-ros2", timeout=HUNG_S)
        assert ran.returncode == 64
        assert said in ran.stdout + ran.stderr


def test_a_plug_in_that_is_mounted_brings_its_robot_without_network_or_a_place_to_write(
    image, plugins
):
    ran = run(image, "--check", flags=mounted(plugins))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert ran.stdout.startswith("robot-shuttle has")
    assert '"event":"plugin_loaded"' in ran.stderr
    assert not list(plugins.rglob("__pycache__"))


def test_interfaces_are_built_for_the_container_and_its_robot_file_has_them(
    image, tmp_path, monkeypatch
):
    builder = f"{image}-interfaces"
    monkeypatch.setenv("TAG", image.rpartition(":")[2])
    subprocess.run([ROOT / "docker" / "image", "interfaces"], check=True, capture_output=True)
    folder = tmp_path / "robot"
    shutil.copytree(SPOT, folder)
    for one in (tmp_path, folder):
        one.chmod(0o755)
    user = ("--user", f"{os.getuid()}:{os.getgid()}", "--volume", f"{folder}:/robot")
    docker("run", "--rm", *user, builder, BUILD, "/robot/interfaces", "/robot")
    where = ("--volume", f"{folder}:{MOUNT}:ro", "--env", f"EDGEVOX_ROBOT_FOLDER={MOUNT}")
    ran = run(image, "--check", flags=where)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "leave_dock" in ran.stdout
    assert "is off" not in ran.stderr


def test_a_broken_plug_in_is_named_and_the_robot_starts_without_it(image, plugins):
    (plugins / "broken-1.0-py3-none-any.whl").write_text("?")
    ran = run(image, "--check", flags=mounted(plugins))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "edgevox: plugins: broken-1.0-py3-none-any.whl: " in ran.stderr


def test_a_plug_in_that_is_not_as_its_hash_says_ends_it_before_anything_is_loaded(image, plugins):
    files = [one for one in plugins.rglob("*") if one.is_file()]
    (plugins / "plugins.sha256").write_text(
        "".join(
            f"{hashlib.sha256(one.read_bytes()).hexdigest()}  ./{one.relative_to(plugins)}\n"
            for one in files
        )
    )
    assert run(image, "--check", flags=mounted(plugins)).returncode == 0
    (plugins / "shuttle" / "shuttle.py").write_text("print('taken over')")
    ran = run(image, "--check", flags=mounted(plugins))
    assert ran.returncode == 64
    assert "shuttle/shuttle.py" in ran.stderr
    assert "taken over" not in ran.stdout


def dockerfiles():
    """Those that docs/deployment.md shows."""
    page = (ROOT / "docs" / "deployment.md").read_text()
    return [part.partition("```")[0] for part in page.split("```dockerfile\n")[1:]]


def test_an_image_of_ones_own_has_its_plug_ins(image, plugins, derive):
    own, _ = dockerfiles()
    assert len(own.splitlines()) <= 4
    made = derive(own.replace("edgevox-ros2:local", image))
    ran = run(made, "--check", flags=("--env", "EDGEVOX_AGENT=robot-shuttle"))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert ran.stdout.startswith("robot-shuttle has")


def test_pip_installs_a_package_into_an_image_of_ones_own_at_build_time(
    image, plugins, derive, monkeypatch
):
    tools = f"{image}-tools"
    monkeypatch.setenv("TAG", image.rpartition(":")[2])
    subprocess.run([ROOT / "docker" / "image", "tools"], check=True, capture_output=True)
    shutil.move(plugins / "shuttle", plugins.parent / "my_package")
    _, own = dockerfiles()
    assert len(own.splitlines()) <= 4
    # Without an index: the example needs nothing, and its builder is among the tools.
    offline = "pip install --no-index --no-deps --no-build-isolation "
    own = own.replace("edgevox-ros2:local-tools", tools).replace("edgevox-ros2:local", image)
    made = derive(own.replace("pip install ", offline))
    ran = run(made, "--check", flags=("--env", "EDGEVOX_AGENT=robot-shuttle"))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "edgevox-shuttle" in ran.stderr


@pytest.fixture
def copied(image, tmp_path, monkeypatch):
    """The template, alone in a folder, as somebody would have it who knows nothing else."""
    target = tmp_path / f"robot-{secrets.token_hex(4)}"
    shutil.copytree(TEMPLATE, target, ignore=shutil.ignore_patterns("__pycache__"))
    for one in (tmp_path, target):
        one.chmod(0o755)
    monkeypatch.setenv("EDGEVOX_IMAGE", image)
    yield target
    subprocess.run(["docker", "compose", "down", "--volumes"], cwd=target, capture_output=True)


def shell(script, folder):
    command = ["bash", "-euo", "pipefail", "-c", script]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=HUNG_S)


def test_the_template_repository_works_when_it_is_copied_alone(copied):
    script = (copied / "README.md").read_text().partition("```bash\n")[2].partition("```")[0]
    assert {"make test", "make up"} <= set(script.splitlines())
    ran = shell(script, copied)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "errand.yaml on robot-porter" in ran.stdout
    assert "delivery.yaml on robot-porter" in ran.stdout
    assert ran.stdout.count("PASSED") == 2


def workflow_script():
    (job,) = yaml.safe_load((ROOT / ".github" / "workflows" / "robot-scenarios.yml").read_text())[
        "jobs"
    ].values()
    return job["steps"][-1]["run"]


def test_the_reusable_workflow_plays_every_scenario_and_fails_with_one(copied, image, monkeypatch):
    given = {"IMAGE": image, "FOLDER": "robot", "EDGEVOX_AGENT": "robot-porter"}
    for name, value in (given | {"EDGEVOX_LLM": "none"}).items():
        monkeypatch.setenv(name, value)
    ran = shell(workflow_script(), copied)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert ran.stdout.count("PASSED") == 2

    scenarios = copied / "robot" / "scenarios"
    (scenarios / "delivery.yaml").unlink()
    errand = scenarios / "errand.yaml"
    errand.write_text(errand.read_text().replace("room: pharmacy", "room: cellar"))
    assert shell(workflow_script(), copied).returncode == 1
    errand.unlink()
    ran = shell(workflow_script(), copied)
    assert ran.returncode == 1
    assert "no scenario in robot/scenarios" in ran.stdout


def test_what_the_template_runs_in_ci_is_what_its_readme_says():
    (job,) = yaml.safe_load((TEMPLATE / ".github" / "workflows" / "scenarios.yml").read_text())[
        "jobs"
    ].values()
    commands = [one["run"] for one in job["steps"] if "run" in one]
    readme = (TEMPLATE / "README.md").read_text()
    assert [one for one in commands if one.startswith("make")] == ["make check", "make test"]
    assert all(one in readme for one in commands if one.startswith("make"))
