"""How the doctor asks and reports, and what becomes of probes that hang or die."""

import json
from pathlib import Path

import pytest
from doctor_rig import ERROR, OK, SKIPPED, WARNING, situation

from edgevox.apps import edgevox
from edgevox.apps.doctor import check
from edgevox.apps.doctor.check import Check, CheckAnswer, CheckVerdict, ask, error, ok, warning
from edgevox.apps.doctor.checks import CHECKS
from edgevox.apps.doctor.command import as_json, print_table, worst
from edgevox.core.probe import ProbeFailed, probe_apart

HERE = "doctor_probes"


@pytest.fixture
def _found_by_children(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))


@pytest.mark.usefixtures("_found_by_children")
def test_a_probe_that_hangs_dies_or_raises_is_a_finding_and_one_that_chats_is_understood():
    assert probe_apart(f"{HERE}:chats") == {"seen": 1}
    with pytest.raises(ProbeFailed, match="SIGSEGV"):
        probe_apart(f"{HERE}:dies")
    with pytest.raises(ProbeFailed, match="no such device"):
        probe_apart(f"{HERE}:raises")
    with pytest.raises(ProbeFailed, match="hangs"):
        probe_apart(f"{HERE}:hangs", timeout_s=2.0)


def test_a_check_that_breaks_is_an_error_and_what_needs_it_is_not_tried(monkeypatch):
    def lost(_address):
        raise ProbeFailed("it ended the process with SIGSEGV")

    monkeypatch.setattr(check, "probe_apart", lost)
    checks = [
        Check("ros2", "", "somewhere:probe", lambda *_: ok("fine"), if_lost="reinstall it"),
        Check("round trip", "", lambda _: {}, lambda *_: ok("fine"), needs=("ros2",)),
        Check("disk", "", lambda _: 1 / 0, lambda *_: ok("fine")),
        Check("clock", "", lambda _: {}, lambda *_: [ok("set"), warning("late")]),
    ]
    answers = ask(checks, situation())
    assert [(one.check, one.verdict.level) for one in answers] == [
        ("ros2", ERROR),
        ("round trip", SKIPPED),
        ("disk", ERROR),
        ("clock", OK),
        ("clock", WARNING),
    ]
    assert answers[0].verdict.advice == "reinstall it"
    assert answers[1].verdict.found == "not tried: see ros2"


def test_the_report_says_all_to_people_and_to_programs(capsys):
    answers = [
        CheckAnswer("clock", ok("set")),
        CheckAnswer("models", error("whisper [base] is damaged", "edgevox-models fetch small")),
        CheckAnswer("sound", warning("no microphone")),
    ]
    assert worst(answers) is ERROR
    assert worst([CheckAnswer("gpu", CheckVerdict(SKIPPED, ""))]) is OK
    print_table(answers)
    table = capsys.readouterr().out
    assert "whisper [base] is damaged" in table
    assert "1 error and 1 warning." in table
    told = json.loads(as_json(answers))
    assert told["status"] == "error"
    assert told["checks"][1]["advice"] == "edgevox-models fetch small"


def test_edgevox_doctor_is_the_doctor(capsys):
    names = {check.name for check in CHECKS}
    assert len(names) == len(CHECKS)
    assert {need for check in CHECKS for need in check.needs} <= names
    with pytest.raises(SystemExit) as ended:
        edgevox.main(["doctor", "--only", "astrology"])
    assert ended.value.code == 2
    assert "astrology" in capsys.readouterr().err
    assert edgevox.main(["doctor", "--only", "python", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["checks"][0]["check"] == "python"


def test_a_flag_that_is_nonsense_is_a_finding(capsys):
    assert edgevox.main(["doctor", "--only", "settings", "--robot-namespace", "my robot"]) == 1
    assert "got 'my robot'" in capsys.readouterr().out
