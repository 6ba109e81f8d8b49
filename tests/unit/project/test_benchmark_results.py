"""The file of results: what is kept of each benchmark, and of which run of it."""

import importlib
import json
import platform
from datetime import timedelta
from pathlib import Path

import pytest
from benchmark_rig import (
    BEGAN,
    FRONT,
    BadResults,
    Figure,
    Measured,
    NotHere,
    Results,
    describing,
    environment,
    found,
    read,
    run,
    sim,
    with_run,
    write,
)

TOP = Path(__file__).resolve().parents[3]


def test_a_partial_run_renews_its_benchmark_and_leaves_the_others_as_they_are():
    both = with_run(with_run(Results(), "sim", found(4.0)), "ros2", found(6.0))

    later = with_run(both, "sim", found(3.0), began=BEGAN + timedelta(days=2), commit=("def", True))

    assert later.runs["ros2"] == both.runs["ros2"]
    assert later.run("sim").figure("ours").value == 3.0
    assert (later.run("sim").commit, later.run("sim").changed) == ("def", True)
    assert later.newest() == BEGAN + timedelta(days=2)


def test_each_benchmark_keeps_the_machine_that_it_ran_on_until_it_runs_elsewhere():
    one, other = environment("Abacus"), environment("Slide rule")
    results = with_run(Results(), "sim", found(4.0), where=one)
    results = with_run(results, "ros2", found(6.0), where=other)

    assert results.environments[results.run("sim").environment] == one
    assert results.environments[results.run("ros2").environment] == other
    moved = with_run(results, "sim", found(4.0), where=other)
    assert list(moved.environments.values()) == [other]


def test_a_file_reads_back_as_it_was_written(tmp_path):
    results = with_run(Results(), "sim", found(4.0, 5.0, 9.0, wanted=4.5))

    write(results, tmp_path / "results.json")

    assert read(tmp_path / "results.json") == results
    assert next(iter(json.loads((tmp_path / "results.json").read_text()))) == "format"
    assert read(tmp_path / "none.json") == Results()


def _unknown_field(data):
    data["runs"]["sim"]["figures"][0]["valu"] = 1.0


def _lost_baseline(data):
    del data["runs"]["sim"]["figures"][1]


def _same_id(data):
    data["runs"]["sim"]["figures"][1]["id"] = "ours"


def _lost_environment(data):
    data["environments"] = {}


def _no_number(data):
    data["runs"]["sim"]["figures"][0]["value"] = "fast"


def _of_another_time(data):
    data["format"] = 2


@pytest.mark.parametrize(
    ("spoil", "named"),
    [
        (_unknown_field, "valu"),
        (_lost_baseline, "plain"),
        (_same_id, "ours"),
        (_lost_environment, "environments"),
        (_no_number, "value"),
        (_of_another_time, "format"),
    ],
)
def test_a_file_that_is_wrong_is_refused_with_what_is_wrong(tmp_path, spoil, named):
    file = tmp_path / "results.json"
    write(with_run(Results(), "sim", found(4.0)), file)
    data = json.loads(file.read_text())
    spoil(data)
    file.write_text(json.dumps(data))

    with pytest.raises(BadResults, match=named):
        read(file)


def test_a_figure_is_the_median_of_its_samples_with_the_least_and_the_most():
    figure = Figure.of("one", "table", "what", [4.0, 1.0, 2.0], "ms", wanted=1.5)

    assert (figure.value, figure.least, figure.most, figure.n) == (2.0, 1.0, 4.0, 3)
    assert figure.missed
    assert not Figure.of("one", "table", "what", [2.0], wanted=1.5, more_is_better=True).missed


def test_what_is_kept_of_a_machine_does_not_name_it():
    kept = describing.environment().model_dump_json()

    assert platform.node() not in kept
    assert platform.python_version() in kept


def test_a_benchmark_that_fails_costs_neither_its_old_figures_nor_the_others(tmp_path, monkeypatch):
    file = tmp_path / "results.json"
    write(with_run(Results(), "sim", found(4.0)), file)

    def measure(name, quick, front):
        if name == "sim":
            raise run.Broken("sim: ended with code 1")
        return found(6.0)

    monkeypatch.setattr(run, "measure", measure)

    assert run.run(["sim", "ros2"], False, file) == run.FAILED
    assert read(file).run("sim").figure("ours").value == 4.0
    assert read(file).run("ros2").figure("ours").value == 6.0


def test_a_benchmark_whose_needs_are_not_here_is_left_out_and_nothing_has_failed(
    tmp_path, monkeypatch
):
    file = tmp_path / "results.json"
    monkeypatch.setattr(run, "measure", lambda *_: None)

    assert run.run(["image"], False, file) == run.OK
    assert read(file) == Results()


def test_what_a_benchmark_lacks_is_told(tmp_path, monkeypatch, capsys):
    def refuse(quick):
        raise NotHere("no abacus")

    monkeypatch.setattr(sim, "measure", refuse)

    assert run.measure_here("sim", False, tmp_path / "found.json") == run.LEFT_OUT
    assert "sim: left out: no abacus" in capsys.readouterr().out


@pytest.fixture
def front_run(tmp_path, monkeypatch):
    """A run of the front table, in a tree and with benchmarks that a test decides about."""

    class FrontRun:
        file = tmp_path / "front.json"
        commits = ("abc", False), ("abc", False)
        found = {name: found(4.0) for name in FRONT}  # noqa: RUF012

        def __call__(self, quick=False):
            commits = iter(self.commits)
            monkeypatch.setattr(run, "commit", lambda: next(commits))
            monkeypatch.setattr(run, "measure", self.measure)
            monkeypatch.setattr(run, "of_the_front", lambda _, measured: measured)
            return run.run_front(quick, self.file)

        def measure(self, name, quick, front):
            assert front
            if name not in self.found:
                raise run.Broken(name)
            return self.found[name]

    return FrontRun()


def test_the_front_table_is_of_one_run_at_one_commit(front_run):
    write(with_run(Results(), "sim", found(1.0)), front_run.file)

    assert front_run() == run.OK
    kept = read(front_run.file)
    assert set(kept.runs) == set(FRONT), "nothing of the run before is left"
    assert kept.apart() == []


@pytest.mark.parametrize(
    ("commits", "why"),
    [
        ([("abc", True)], "commit your changes first"),
        ([("", True)], "commit your changes first"),
        ([("abc", False), ("abc", True)], "commit your changes first"),
        ([("abc", False), ("def", False)], "it began at commit abc, is def now"),
    ],
)
def test_a_front_table_of_no_commit_or_of_several_is_not_kept(front_run, commits, why):
    front_run.commits = commits

    with pytest.raises(BadResults, match=why):
        front_run()
    assert not front_run.file.exists()


def test_a_front_table_of_which_something_failed_is_not_kept(front_run, capsys):
    del front_run.found["voice"]

    assert front_run() == run.FAILED
    assert not front_run.file.exists()
    assert "failed: voice" in capsys.readouterr().err


def test_the_front_table_can_be_tried_with_changes(front_run):
    front_run.commits = [("abc", True)]

    assert front_run(quick=True) == run.OK
    assert read(front_run.file).quick() == sorted(FRONT)


def test_of_a_benchmark_the_front_table_keeps_what_the_readme_shows():
    one = Figure.of("resident", "Memory", "resident", [1.0], "MB", baseline="plain")
    plain, more = (Figure.of(name, "Memory", name, [2.0], "MB") for name in ("plain", "more"))

    kept = run.of_the_front("memory", Measured(figures=(more, one, plain)))

    assert [figure.id for figure in kept.figures] == ["resident", "plain"]


@pytest.mark.parametrize(
    "module", sorted(str(one.relative_to(TOP)) for one in TOP.glob("benchmarks/**/*.py"))
)
def test_what_a_benchmark_imports_is_there(module):
    name = module.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    assert importlib.import_module(name)
