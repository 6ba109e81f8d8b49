"""One name, one thing: no class and no file of EdgeVox is called like another one."""

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import edgevox

PACKAGE = Path(edgevox.__file__).parent
OF_A_BODY = {"robot.py", "scene.py", "skills.py"}
"""What the folder of a body is made of: who knows one finds `robots/panda/robot.py`."""
BODIES = ("robots/humanoid", "robots/panda", "robots/places", "ros2/external")
ABOVE = {"agent/skills.py", "apps/robot.py"}
"""What a skill is, for every `skills.py`; and where older packages import a `Robot` from."""


def modules() -> Iterator[Path]:
    return (path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py"))


def classes(module: Path) -> list[str]:
    return re.findall(r"^class (\w+)", (PACKAGE / module).read_text(encoding="utf-8"), re.MULTILINE)


def test_no_two_modules_have_a_class_of_one_name_be_it_private() -> None:
    found = defaultdict(list)
    for module in modules():
        for name in classes(module):
            found[name.lstrip("_")].append(str(module))
    assert {name: where for name, where in found.items() if len(where) > 1} == {}


def test_files_have_one_name_each_but_for_those_that_every_body_has() -> None:
    found = defaultdict(list)
    for module in modules():
        ours = module.name in OF_A_BODY and module.parent.as_posix() in BODIES
        if module.name != "__init__.py" and not ours and module.as_posix() not in ABOVE:
            found[module.name].append(str(module))
    assert {name: where for name, where in found.items() if len(where) > 1} == {}
    assert not OF_A_BODY & set(found)
