"""`edgevox interfaces`: packages of a robot's interfaces, found and built in order."""

from pathlib import Path

import pytest

from edgevox.apps.edgevox import main
from edgevox.ros2.interface_packages import packages_in

LAMP = "uint8 OFF=0\nuint8 ON=1\nuint8 state\n"


@pytest.fixture
def source(tmp_path):
    """Write files of packages; the folder that they are in."""

    def write(**files: str) -> Path:
        for name, content in files.items():
            package, kind, definition = name.split("__")
            file = tmp_path / "src" / package / kind / f"{definition}.{kind}"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(content)
        return tmp_path / "src"

    return write


@pytest.fixture
def refused(capsys, tmp_path):
    """What is said of packages that cannot be built."""

    def refused(*sources: Path) -> str:
        to = ("--to", str(tmp_path / "built"))
        assert main(["interfaces", *map(str, sources), *to]) == 1
        assert not list(tmp_path.glob("built/share/*"))
        return capsys.readouterr().err

    return refused


def test_packages_are_found_at_any_depth_by_the_name_in_their_package_xml(source):
    folder = source(deep__msg__Lamp=LAMP)
    (folder / "deep" / "package.xml").write_text("<package><name> lamp_msgs </name></package>")
    (folder / "no_definitions" / "msg").mkdir(parents=True)
    (one,) = packages_in(folder.parent)
    assert (one.name, list(one.files), one.needs) == ("lamp_msgs", ["msg/Lamp.msg"], frozenset())


def test_a_package_needs_those_whose_types_it_has(source):
    definition = (
        "# my_msgs/Note\nstd_msgs/Header header\n---\nother_msgs/msg/Part[<=3] parts\n"
        "string text  # see third_msgs/Text\n---\nOwn own\na_msgs/Own own2\n"
    )
    (one,) = packages_in(source(a_msgs__action__Do=definition))
    assert one.needs == {"std_msgs", "other_msgs"}


def test_packages_that_are_needed_and_not_there_are_all_named(source, refused):
    folder = source(a_msgs__msg__A="gone_msgs/Part part\n", b_msgs__msg__B="lost_msgs/B[] b\n")
    told = refused(folder)
    assert "a_msgs needs gone_msgs; b_msgs needs lost_msgs" in told


def test_packages_that_need_each_other_are_refused(source, refused):
    folder = source(a_msgs__msg__A="b_msgs/B b\n", b_msgs__msg__B="a_msgs/A a\n")
    assert "a_msgs" in refused(folder)


def test_what_is_no_package_or_has_no_name_for_one_is_refused(source, refused, tmp_path):
    (tmp_path / "empty").mkdir()
    assert "expected a folder, at any depth" in refused(tmp_path / "empty")
    assert "my_msgs" in refused(source(**{"A-Package__msg__A": LAMP}))
    (tmp_path / "note.txt").write_text("no archive")
    assert "note.txt" in refused(tmp_path / "note.txt")


def test_a_package_of_ros_2_itself_is_left_alone(source, tmp_path, capsys):
    to = tmp_path / "built"
    assert main(["interfaces", str(source(std_msgs__msg__Own=LAMP)), "--to", str(to)]) == 0
    assert "std_msgs is already there" in capsys.readouterr().out
    assert not (to / "share").exists()
