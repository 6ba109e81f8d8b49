"""Wrong files are data: each case in `<kind>/*.yaml` is refused by its field, never otherwise.

A case says what stands in a file, and what has to be said of it:

    a width that is no number:
      file: "world: {width: ten}"   # all of it; or
      add: "world: {width: ten}"    # lines that stand where the base says `# here`; or
      change: {"width: 5": "width: ten"}           # other words in the base
      repeat: {text: "- say: go {n}\\n", times: 9}  # follows the rest so often; {n} counts
      error: {line: 2, field: world.width, got: ten, expected: number}

`expected` is a part of the sentence, or several, that any good sentence has. Without `line` the
field is a setting, a variable or a path; without `field` the error is about the whole file. The
cases of `any` are tried with every kind of YAML file. In each place of a `whole.yaml`, which has no
cases, whatever is odd is tried.
"""

import math
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import helm_python as helm
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel
from std_msgs.msg import String

from edgevox.agent.policy.policy import read_policy_file
from edgevox.apps.container import prepared
from edgevox.core.errors import InvalidValue, shorten
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES
from edgevox.core.files.yaml_file import YamlFile, parse_yaml
from edgevox.core.settings import Settings
from edgevox.robots.world.load import load_world
from edgevox.ros2.external import EXTERNAL
from edgevox.ros2.external.settings import load_locations
from edgevox.scenario import load_scenario

HERE = Path(__file__).parent
LONGEST_MESSAGE = 1000
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import chart  # noqa: E402


class Wanted(BaseModel, extra="forbid"):
    """What an error has to say."""

    line: int | None = None
    field: str | None = None
    got: Any = None
    expected: str | int | float | list[str | int]


class Repeat(BaseModel, extra="forbid"):
    text: str = ""
    times: int = 0


class Case(BaseModel, extra="forbid"):
    """What stands in a file."""

    file: str | None = None
    add: str = ""
    change: dict[str, str] = {}
    repeat: Repeat = Repeat()
    error: Wanted

    def text(self, base: str) -> str:
        text = base if self.file is None else self.file
        if self.add:
            text, found = re.subn(r"^( *)# here$", self._added, text, flags=re.MULTILINE)
            assert found == 1, "the base says once, on a line of its own, `# here`"
        for old, new in self.change.items():
            assert old in text, f"the base has no {old!r}"
            text = text.replace(old, new)
        repeated = (self.repeat.text.replace("{n}", str(n)) for n in range(self.repeat.times))
        return text + "".join(repeated)

    def _added(self, here: re.Match[str]) -> str:
        return "\n".join(here[1] + line for line in self.add.splitlines())


class CaseFile(BaseModel, extra="forbid"):
    base: str = ""
    cases: dict[str, Case]


@dataclass(frozen=True)
class Kind:
    """How a kind of file is read, which raises `InvalidValue`; and the setting that names one."""

    load: Callable[[Path], object]
    setting: str = ""


class Dock:
    """A type of an action: ROS 2's packages in the Python index have none."""

    Goal = Result = Feedback = String


def load_robot(file: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "docking", SimpleNamespace())
        patch.setitem(sys.modules, "docking.action", SimpleNamespace(Dock=Dock))
        EXTERNAL.build(Settings(robot_file=file), None)


def load_environment(file: Path) -> None:
    """Variables of a container, in which ROS 2 has one middleware."""
    index = file.parent / "share/ament_index/resource_index/rmw_typesupport"
    index.mkdir(parents=True, exist_ok=True)
    (index / "rmw_fastrtps_cpp").touch()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AMENT_PREFIX_PATH", str(file.parent))
        prepared(parse_yaml(file.read_text("utf-8"), file.name), pytest.fail)


def load_chart_values(file: Path) -> None:
    """Helm says several paths, of which the deepest is the field; the chart itself says one."""
    try:
        chart.render(parse_yaml(file.read_text("utf-8"), file.name))
    except helm.HelmError as error:
        said = str(error)
        paths = re.findall(r"at '(.*?)': ", said) or re.findall(r"at \(.*?\): (\S+): ", said)
        raise InvalidValue(max(paths, key=len), None, said) from error


KINDS = {
    "chart": Kind(load_chart_values),
    "environment": Kind(load_environment),
    "locations": Kind(load_locations, "locations"),
    "policy": Kind(read_policy_file, "policy"),
    "robot": Kind(load_robot, "robot_file"),
    "scenario": Kind(load_scenario, "scenario"),
    "world": Kind(load_world, "world"),
}
NAMED = [name for name, kind in KINDS.items() if kind.setting]


def read(path: Path) -> CaseFile:
    file = YamlFile(path.read_text("utf-8"), str(path.relative_to(HERE)))
    return file.read(CaseFile, file.data)


FILES = {f"{path.parent.name}/{path.stem}": read(path) for path in sorted(HERE.glob("*/*.yaml"))}
BASES = [
    pytest.param(name.split("/")[0], file.base, id=name)
    for name, file in FILES.items()
    if file.base
]
ODD = [None, 0, -1, 1e9, 10**400, math.inf, math.nan, True, "x", "", "(", "{x}", "[", "a\0b"]
ODD += [[], {}, [1], [None], [1, 2, 3], [[1, 2]], {"name": "circle"}, {1: 2}, {"": ""}]


def cases() -> Iterator[Any]:
    for name, file in FILES.items():
        folder, _, stem = name.partition("/")
        for kind in NAMED if folder == "any" else [folder]:
            for title, case in file.cases.items():
                yield pytest.param(kind, case, file.base, id=f"{kind}/{stem}: {title}")


def check(kind: Kind, file: Path, wanted: Wanted) -> None:
    with pytest.raises(InvalidValue) as caught:
        kind.load(file)
    error, field = caught.value, wanted.field
    if wanted.line is not None:
        field = f"{file.name}:{wanted.line}" + ("" if field is None else f": {field}")
    assert error.field == (file.name if field is None else field)
    expected = wanted.expected if isinstance(wanted.expected, list) else [wanted.expected]
    for part in expected:
        assert str(part) in error.expected
    if "got" in wanted.model_fields_set:
        assert shorten(error.value) == shorten(wanted.got)
    if kind.setting:
        assert len(str(error)) < LONGEST_MESSAGE
        assert "\n" not in str(error)


def written(folder: Path, kind: str, text: str) -> Path:
    file = folder / f"{kind}.yaml"
    file.write_text(text, "utf-8")
    return file


@pytest.mark.parametrize(("kind", "case", "base"), list(cases()))
def test_a_wrong_file_is_refused_by_its_field(tmp_path, kind, case, base):
    check(KINDS[kind], written(tmp_path, kind, case.text(base)), case.error)


@pytest.mark.parametrize("kind", NAMED)
def test_what_is_no_small_text_is_refused_by_the_setting_that_names_it(tmp_path, kind):
    (tmp_path / "folder").mkdir()
    (tmp_path / "large").write_bytes(b"#" * (LARGEST_TEXT_BYTES + 1))
    (tmp_path / "binary").write_bytes(b"\xff\xfe\x00")
    for name, expected in (
        ("nowhere", "No such file"),
        ("folder", "Is a directory"),
        ("large", str(LARGEST_TEXT_BYTES)),
        ("binary", "UTF-8"),
    ):
        file = tmp_path / name
        wanted = Wanted(field=KINDS[kind].setting, got=str(file), expected=expected)
        check(KINDS[kind], file, wanted)


@pytest.mark.parametrize(("kind", "base"), BASES)
def test_a_base_is_right_and_as_a_case_it_fails(tmp_path, kind, base):
    file = written(tmp_path, kind, base)
    KINDS[kind].load(file)
    with pytest.raises(pytest.fail.Exception, match="DID NOT RAISE"):
        check(KINDS[kind], file, Wanted(expected=""))


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every key and index of a file, with what it is in."""
    if isinstance(value, dict | list):
        for key in value if isinstance(value, dict) else range(len(value)):
            yield value, key
            yield from places(value[key])


@pytest.mark.parametrize("kind", NAMED)
@given(st.data())
def test_with_anything_in_any_place_a_file_is_taken_or_refused_by_its_field(
    tmp_path_factory, kind, data
):
    content = yaml.safe_load(FILES[f"{kind}/whole"].base)
    holder, key = data.draw(st.sampled_from(list(places(content))))
    holder[key] = data.draw(st.sampled_from(ODD))
    file = written(tmp_path_factory.getbasetemp(), kind, yaml.safe_dump(content))
    refusals = []
    try:
        KINDS[kind].load(file)
    except InvalidValue as error:
        refusals.append(error.field)
    assert all(field.startswith(file.name) for field in refusals)


RIGHT = {"line": 1, "field": "dock.y", "got": "far", "expected": "number"}


@pytest.mark.parametrize(
    "other",
    [{"line": 2}, {"line": None}, {"field": "dock.x"}, {"got": "near"}, {"expected": "text"}],
    ids=str,
)
def test_a_case_of_which_something_else_is_said_fails(tmp_path, other):
    file = written(tmp_path, "locations", "dock: {x: 1, y: far}")
    look = partial(check, KINDS["locations"], file)
    look(Wanted(**RIGHT))
    with pytest.raises(AssertionError):
        look(Wanted(**RIGHT | other))


def test_a_case_in_which_anything_else_is_raised_fails(tmp_path):
    with pytest.raises(KeyError):
        check(Kind(lambda file: {}[file]), tmp_path, Wanted(expected=""))
