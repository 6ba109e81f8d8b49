"""`edgevox doctor` for real, as a process on this machine."""

import os
from functools import partial

import pytest
from doctor_process import ask_doctor
from waiting import wait_until

from edgevox.apps.doctor.checks import CHECKS
from edgevox.core.probe import probe_apart
from edgevox.models import Store

ODD = {"EDGEVOX_LANGAUGE": "en"}


@pytest.fixture
def doctor(domain):
    """Runs it; its exit code, and its verdicts by check."""
    return partial(ask_doctor, domain=domain)


@pytest.mark.long
def test_this_machine_is_well_and_every_check_has_an_answer(doctor):
    code, checks = doctor()
    errors = [one for said in checks.values() for one in said if one["grade"] == "error"]
    assert errors == []
    assert code == 0
    assert list(checks) == [check.name for check in CHECKS]
    assert checks["round trip"][0]["grade"] == "ok"
    assert checks["models"][0]["grade"] == "ok"
    assert checks["robot file"][0]["grade"] == "skipped"


def test_a_truncated_model_is_found_and_the_command_that_fetches_it_told(doctor, tmp_path):
    store, name = Store(), "whisper-tiny.en"
    model = store.manifest.models[name]
    for file in model.files:
        place = tmp_path / name / file.name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.symlink_to(store.folder(model) / file.name)
    arguments = ["--only", "models"]
    environment = {"EDGEVOX_MODELS_DIR": str(tmp_path), "EDGEVOX_LLM": "none"}
    code, checks = doctor(*arguments, "--only", "settings", **environment, **ODD)
    assert code == 0  # its voice is missing, which espeak-ng makes up for, and it is not strict
    assert checks["settings"][0]["grade"] == "warning"
    largest = max(model.files, key=lambda file: file.size).name
    whole = tmp_path / name / largest
    start = whole.read_bytes()[:1000]
    whole.unlink()
    whole.write_bytes(start)
    code, checks = doctor(*arguments, **environment)
    (damaged, *_) = checks["models"]
    assert (code, damaged["found"]) == (1, f"{name} is damaged")
    assert "edgevox-models fetch" in damaged["advice"]


@pytest.mark.parametrize(
    ("variable", "value", "blamed", "advice"),
    [
        ("ROS_DOMAIN_ID", "999", "domain", "0 to 232"),
        pytest.param(
            "RMW_IMPLEMENTATION",
            "rmw_nonsense",
            "ros2",
            "RMW_IMPLEMENTATION",
            marks=pytest.mark.long,
        ),
    ],
)
def test_nonsense_in_the_environment_is_blamed_and_told_how_to_correct(
    doctor, variable, value, blamed, advice
):
    only = [part for name in ("ros2", "domain", "round trip") for part in ("--only", name)]
    code, checks = doctor(*only, **{variable: value})
    (said,) = checks[blamed]
    assert (code, said["grade"]) == (1, "error")
    assert advice in said["advice"]
    assert checks["round trip"][0]["grade"] == "skipped"


def test_an_archive_for_support_has_the_nodes_and_topics_of_the_domain(peer, domain):
    peer()
    here = {**os.environ, "ROS_DOMAIN_ID": str(domain)}

    def graph():
        return probe_apart("edgevox.ros2.doctor:graph", environment=here)

    wait_until(lambda: "/peer" in graph()["nodes"], "the peer on the graph")
    assert graph()["topics"]["/rosout"]["types"] == ["rcl_interfaces/msg/Log"]


def test_warnings_fail_when_it_is_strict(doctor):
    code, checks = doctor("--only", "settings", "--strict", **ODD)
    assert code == 1
    assert "EDGEVOX_LANGUAGE" in checks["settings"][0]["found"]
