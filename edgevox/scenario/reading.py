"""Reads scenario files; what is wrong in one is said by field and line."""

from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import read_text
from edgevox.core.yaml_file import YamlFile
from edgevox.scenario.scenario import Scenario
from edgevox.scenario.scenario_steps import STEPS


def load_scenario(file: Path) -> Scenario:
    """The scenario in a file. Raises `InvalidValue` naming the field, its line, what is wrong."""
    return parse_scenario(read_text(file, "scenario"), file.name)


def parse_scenario(text: str, name: str) -> Scenario:
    """As `load_scenario`; `name` is the file's name in messages."""
    file = YamlFile(text, name, tags=STEPS)
    if not isinstance(file.data, dict):
        raise InvalidValue(name, file.data, "a mapping with steps")
    return file.read(Scenario, file.data)
