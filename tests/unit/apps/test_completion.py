"""What Tab offers for EdgeVox's commands."""

import shlex
import subprocess

import pytest

from edgevox.apps import edgevox
from edgevox.apps.robots import ROBOTS
from edgevox.core.languages import LANGUAGES


@pytest.fixture
def script(capsys):
    def printed(shell: str) -> str:
        assert edgevox.main(["completion", shell]) == 0
        return capsys.readouterr().out

    return printed


def offered(script: str, *words: str) -> set[str]:
    """What bash offers for the last of these words."""
    name = words[0].replace("-", "_")
    press = (
        f"COMP_WORDS=({shlex.join(words)}); COMP_CWORD={len(words) - 1}; _{name};"
        ' printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "--norc", "-c", f"{script}\n{press}"], capture_output=True, text=True, check=True
    )
    assert not done.stderr
    return set(done.stdout.split())


def test_bash_offers_robots_flags_and_the_values_of_a_flag(script):
    text = script("bash")
    assert offered(text, "edgevox-agent", "robot-") == {one for one in ROBOTS if "robot-" in one}
    flags = offered(text, "edgevox-agent", "robot-external", "--robot-")
    assert flags == {"--robot-file", "--robot-namespace"}
    assert offered(text, "edgevox-agent", "--confirm", "") == {"always", "unsure", "never"}
    assert offered(text, "edgevox-agent", "--confirm", "=", "u") == {"unsure"}
    assert offered(text, "edgevox-agent", "--language", "") == set(LANGUAGES)
    assert offered(text, "edgevox-agent", "--seed", "") == set()
    assert "domain" in offered(text, "edgevox-doctor", "--only", "")


def test_bash_offers_files_where_a_flag_takes_one(script, tmp_path):
    (tmp_path / "robot.yaml").touch()
    text = script("bash")
    start = str(tmp_path / "rob")
    assert offered(text, "edgevox-agent", "--robot-file", start) == {f"{start}ot.yaml"}


def test_zsh_reads_what_bash_reads(script):
    first, _, rest = script("zsh").partition("\n")
    assert first == "autoload -Uz bashcompinit && bashcompinit"
    assert rest == script("bash")


def test_fish_has_each_flag_with_its_sentence(script):
    lines = [shlex.split(line) for line in script("fish").splitlines()]
    assert all(line[:2] == ["complete", "-c"] for line in lines)
    (confirm,) = [line for line in lines if "confirm" in line]
    assert confirm[confirm.index("-a") + 1].split() == ["always", "unsure", "never"]
    (file,) = [line for line in lines if "robot-file" in line and "edgevox-agent" in line]
    assert {"-r", "-F"} <= set(file)
    assert "YAML file that describes the robot" in file[file.index("-d") + 1]
