"""Each benchmark runs in a process of its own."""

import pytest
from benchmark_rig import run


@pytest.mark.long
def test_a_benchmark_runs_in_a_process_of_its_own_and_its_figures_come_back():
    measured = run.measure("sim", quick=True)

    assert {figure.id for figure in measured.figures} >= {"steps", "scans", "plan"}
    assert all(figure.value > 0 for figure in measured.figures)
