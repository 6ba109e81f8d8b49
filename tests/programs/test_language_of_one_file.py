"""A language is one file: with it in the folder a robot obeys and answers, with no code changed."""

import os
import shutil
import sys
from pathlib import Path

import pytest
from guards import run_program

import edgevox
from edgevox.core.languages import CODES

PACKAGE = Path(edgevox.__file__).parent
WORDS = {
    'name = "English"': 'name = "Glossian"',
    '"stop", "halt",': '"vorth",',
    "<please> ((<drive>|<bring>) <to>|": "<please> (zorp <to>|(<drive>|<bring>) <to>|",
    'says = "Going to the {room}."': 'says = "Zorpin tu {room}."',
    'standing = "I am standing still."': 'standing = "Ib vortha."',
}
"""What its file says otherwise than the English one."""
EMPTY = "name = 'G'\nsigns = {}\nstt = ''\ntts = []\nespeak = 'en'\n"
TALK = "import sys; from edgevox.apps.agent.main import main; sys.exit(main(sys.argv[1:]))"


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    """A folder with a copy of the package, which has one language more."""
    folder = copy(tmp_path_factory.mktemp("copy"))
    text = (PACKAGE / "core/languages/en.toml").read_text("utf-8")
    for english, own in WORDS.items():
        assert english in text, english
        text = text.replace(english, own)
    add(folder, text)
    return folder


def copy(folder):
    """With what Python has compiled, but for what it writes at this moment."""
    shutil.copytree(PACKAGE, folder / "edgevox", ignore=shutil.ignore_patterns("*.pyc.*"))
    return folder


def add(folder, text):
    (folder / "edgevox/core/languages/xx.toml").write_text(text, "utf-8")


def run(folder, program, *arguments, said=""):
    return run_program(
        [sys.executable, "-c", program, *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder)},
        input=said,
    )


def talk(folder, language, said):
    flags = ("robot-apartment", "--text-mode", "--llm=none", f"--language={language}")
    return run(folder, TALK, *flags, said=said)


def test_a_robot_obeys_and_answers_in_a_language_of_one_more_file(copied):
    done = talk(copied, "xx", "vorth\nzorp to the kitchen\n")

    assert (done.returncode, done.stderr) == (0, "")
    assert "Ib vortha." in done.stdout
    assert "Zorpin tu kitchen." in done.stdout


def test_it_is_stopped_by_the_words_of_that_file_and_by_english_ones(copied):
    program = (
        "from edgevox.agent.stop.words import SafetyWords as S; import sys\n"
        "for said in sys.argv[1:]: print(bool(S('xx').find(said)), bool(S('en').find(said)))"
    )
    done = run(copied, program, "vorth", "VORTH!", "halt", "zorp to the kitchen, no, vorth")

    # Another language's counts elsewhere alone or first.
    assert done.stdout.splitlines() == [*["True True"] * 3, "True False"]


def test_it_is_listed_after_all_others_with_its_name(copied):
    program = "from edgevox.core.languages import LANGUAGES as L; print(*L, L['xx'].name)"

    assert run(copied, program).stdout.split() == [*CODES, "xx", "Glossian"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('name = "Glossian"', "languages/xx.toml: it has no 'signs'"),
        ("name = ", "languages/xx.toml: Invalid value"),
        (EMPTY + "[stop]\nalone = []", "languages/xx.toml: [stop] has anywhere, and at most alone"),
    ],
)
def test_a_file_that_cannot_be_used_is_told_by_its_name(tmp_path, text, told):
    add(copy(tmp_path), text)
    done = talk(tmp_path, "xx", "vorth\n")

    assert done.returncode != 0
    assert told in done.stderr
    assert "Traceback" not in done.stderr


def test_programs_read_the_file_of_no_language_that_they_do_not_speak():
    read = (
        "import edgevox.core.settings, edgevox.core.languages as one;"
        "from edgevox.core.languages import language_file as file;"
        "one.LANGUAGES['en']; print(file.cache_info().currsize)"
    )

    assert run(PACKAGE.parent, read).stdout.strip() == "1"
