"""Every command that a page shows is run by a test, or says what it needs that no test has."""

import ast
import re
import subprocess
from pathlib import Path

import pytest
import yaml
from page_commands import PAGES, ROOT, commands, fences, programs, proofs

from edgevox.apps.agent.main import parse_arguments
from edgevox.apps.container import ENVIRONMENT
from edgevox.apps.robots import ROBOTS
from edgevox.core.settings import check_settings
from edgevox.models.manifest import builtin_manifest
from edgevox.ros2 import contract, standard_topics

TABLE = proofs()
SHOWN = {command: page for page in reversed(PAGES) for command in commands(page)}
NEEDS = {
    "Podman, and systemd as process 1",
    "PyTorch",
    "a cluster",
    "a package index",
    "a registry",
    "a sound card",
    "an installed ROS 2",
    "another machine",
    "jq",
    "people's recordings",
    "people's sentences",
}
OF_EXAMPLES = {"robot-shuttle", "robot-watchman"}
MOUNTED, EXAMPLE = "/etc/edgevox/robot", "examples/robot_repository/robot"
"""Where compose/robot.yml has the folder that the page names."""
TYPES = {
    **{one.topic: one.type for one in (*contract.PUBLISHED, *contract.SUBSCRIBED)},
    **{one.topic: one.type for one in standard_topics.INTEROP},
}


def proof_of(command):
    return next((proof for proof in TABLE if proof.covers(command)), None)


def started(name):
    """Arguments of every start of a program on the pages, also those after an entrypoint."""
    found = []
    for command in SHOWN:
        for part in programs(command):
            names = [word if "=" in word else Path(word).name for word in part]
            if name in names:
                found.append(part[names.index(name) + 1 :])
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_a_page_says_what_it_is(page):
    languages = {language for language, _ in fences(page)}
    assert languages <= {
        "bash",
        "sh",
        "console",
        "text",
        "yaml",
        "toml",
        "python",
        "json",
        "dockerfile",
    }


def test_of_every_command_the_table_says_how_it_is_known_to_work():
    unknown = [f"{page.name}: {one}" for one, page in SHOWN.items() if not proof_of(one)]
    assert not unknown, "add them to tests/docs/commands.toml:\n" + "\n".join(unknown)


def test_every_entry_of_the_table_is_of_one_kind_and_of_use():
    used = {id(proof_of(command)) for command in SHOWN}
    for proof in TABLE:
        assert sum(map(bool, (proof.run, proof.dry, proof.test, proof.needs))) == 1, proof
        assert id(proof) in used, f"no page shows what this covers: {proof.commands}"


def test_what_a_command_needs_is_one_of_a_few_things():
    assert {proof.needs for proof in TABLE if proof.needs} == NEEDS


@pytest.mark.parametrize("named", sorted({proof.test for proof in TABLE if proof.test}))
def test_the_test_that_runs_a_command_is_there(named):
    file, _, function = named.partition("::")
    text = (ROOT / file).read_text()
    if function:
        assert function in {
            node.name for node in ast.walk(ast.parse(text)) if hasattr(node, "name")
        }


def test_what_make_is_asked_for_it_can_do():
    asked = {
        command: part
        for command in SHOWN
        for part in programs(command)
        if part[0] == "make" and proof_of(command).dry
    }
    assert asked
    for command, part in asked.items():
        dry = [*part, "--dry-run", "--no-print-directory"]
        done = subprocess.run(dry, cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0, f"{command}: {done.stderr}"


def test_the_agent_takes_what_it_is_given():
    for arguments in started("edgevox-agent"):
        if not arguments or arguments[0] in ("--help", "--version"):
            continue
        robot, *rest = (word for word in arguments if word != "-")
        assert robot in {*ROBOTS, *OF_EXAMPLES, "ROBOT"}
        asked = parse_arguments(["robot-apartment", *rest])
        check_settings(asked.flags)


def test_models_that_are_named_are_in_the_manifest():
    known = {*builtin_manifest().sets, *builtin_manifest().models}
    for arguments in started("edgevox-models"):
        assert arguments[0] in ("list", "fetch", "verify", "path", "licences")
        assert set(arguments[1:]) <= known


def test_files_of_this_repository_that_are_named_are_there():
    named = re.compile(
        r"(?<!/robot/)(?:examples|scenarios|scripts|compose|helm|tests)/[\w./-]*[\w/]"
    )
    for command in SHOWN:
        for path in named.findall(
            command.replace("/opt/edgevox/scenarios", "scenarios").replace(MOUNTED, EXAMPLE)
        ):
            assert (ROOT / path).exists() or list(ROOT.glob(f"{path}*")), command


def test_what_is_sent_on_ros_2_is_what_the_contract_takes():
    checked = 0
    for verb, *rest in started("ros2"):
        match (verb, [word for word in rest if not word.startswith("--")]):
            case "topic", ["pub", topic, kind, message]:
                assert TYPES[topic.removeprefix("/edgevox/")] == kind
                assert isinstance(yaml.safe_load(message), dict)
            case "topic", ["echo" | "info", topic]:
                assert topic == "/diagnostics" or topic.removeprefix("/edgevox/") in TYPES
            case "service", ["call", service, "std_srvs/srv/Trigger"]:
                assert service.removeprefix("/edgevox/") in contract.QUERIES
            case "param", ["set" | "get", node, name, *_]:
                assert node == "/edgevox/edgevox"
                assert name in {one.name for one in contract.PARAMETERS}
            case "action", ["send_goal", action, kind, goal]:
                assert (action.removeprefix("/edgevox/"), kind) == contract.ACTION
                assert set(yaml.safe_load(goal)) == {"skill_name", "arguments_json"}
            case _:
                continue
        checked += 1
    assert checked > 10


def test_variables_that_are_set_are_settings():
    for command in SHOWN:
        for name in re.findall(r"\bEDGEVOX_(\w+)=", command):
            assert f"EDGEVOX_{name}" in ENVIRONMENT, command
