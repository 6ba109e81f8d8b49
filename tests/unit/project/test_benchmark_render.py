"""The pages show the newest figures, the README those of one run, and a check says so if not."""

import re

import pytest
from benchmark_rig import (
    BENCHMARKS,
    FRONT,
    FRONT_FILE,
    Bar,
    Dot,
    Measured,
    Results,
    bars,
    calibrated,
    environment,
    found,
    front,
    measured,
    number,
    read,
    reliability,
    render,
    with_run,
    write,
)

PAGE = "By hand.\n\n<!-- figures: sim -->\nold\n<!-- end -->\n\nBy hand, too.\n"


@pytest.fixture
def house(tmp_path, monkeypatch):
    """A README, a page of figures and a folder of pictures, and results that belong there."""
    monkeypatch.setattr(render, "PLOTS", {"plot.svg": lambda _: "<svg/>\n"})
    (tmp_path / "docs" / "images").mkdir(parents=True)
    (tmp_path / "README.md").write_text(PAGE)
    (tmp_path / "docs" / "figures.md").write_text(PAGE)

    class House:
        results = tmp_path / "results.json"
        front = tmp_path / "front.json"
        readme = tmp_path / "README.md"
        plot = tmp_path / "docs" / "images" / "plot.svg"

        def keep(self, *values, **more):
            kept = with_run(Results(), "sim", found(*values, wanted=3.0), **more)
            write(kept, self.results)
            write(kept, self.front)

        def render(self, *arguments):
            files = ("--results", str(self.results), "--front", str(self.front))
            return render.main([*arguments, *files], tmp_path)

    made = House()
    made.keep(4.0)
    return made


def test_figures_are_put_between_their_marks_and_all_else_stays(house):
    assert house.render("write") == 0

    text = house.readme.read_text()
    assert text.startswith("By hand.\n\n<!-- figures: sim -->\n")
    assert text.endswith("<!-- end -->\n\nBy hand, too.\n")
    assert "old" not in text
    assert "| ours | 4 ms | **3 ms** | 2 ms | 2 |" in text
    assert "commit `abc123`" in text
    assert house.plot.read_text() == "<svg/>\n"


def test_the_check_is_content_with_what_was_just_written_and_tells_its_age(house, capsys):
    house.render("write")

    assert house.render("check") == 0
    assert "figures of 2026-03-14" in capsys.readouterr().out


def test_the_check_fails_and_names_the_page_when_newer_figures_are_there(house, capsys):
    house.render("write")
    house.keep(5.0)

    assert house.render("check") == 1
    told = capsys.readouterr().err
    assert "README.md: not from the newest front.json" in told
    assert "docs/figures.md: not from the newest results.json" in told


def test_the_check_fails_when_somebody_improved_a_figure_by_hand(house):
    house.render("write")
    house.readme.write_text(house.readme.read_text().replace("| 4 ms |", "| 3 ms |"))

    assert house.render("check") == 1


def test_the_check_fails_when_a_plot_is_missing(house, capsys):
    house.render("write")
    house.plot.unlink()

    assert house.render("check") == 1
    assert "plot.svg" in capsys.readouterr().err


def test_quick_figures_are_refused_and_the_benchmark_named(house, capsys):
    house.keep(4.0, quick=True)

    assert house.render("write") == 1
    assert house.render("check") == 1
    assert "measured with --quick: sim" in capsys.readouterr().err
    assert house.readme.read_text() == PAGE


def test_a_look_at_quick_figures_says_what_they_are_and_does_not_pass_the_check(house):
    house.keep(4.0, quick=True)

    assert house.render("write", "--provisional") == 0
    assert "Too few rounds to be quoted" in house.readme.read_text()
    assert house.render("check", "--provisional") == 1


def test_a_benchmark_that_was_never_run_is_named_with_the_command_that_runs_it(house, capsys):
    house.readme.write_text(PAGE.replace("sim", "ros2"))

    assert house.render("check") == 1
    assert "make bench ARGS='--only ros2'" in capsys.readouterr().err


def test_a_block_that_nobody_knows_is_refused(house, capsys):
    house.readme.write_text(PAGE.replace("sim", "sum"))

    assert house.render("write") == 1
    assert "there is no block sum" in capsys.readouterr().err


def test_the_same_figures_always_make_the_same_picture():
    rows = [Bar("one", 0.5, "0.50"), Bar("<two>", 20.0, "20.0")]

    picture = bars("Time", rows, logarithmic=True, mark=1.0)

    assert picture == bars("Time", rows, logarithmic=True, mark=1.0)
    assert "&lt;two&gt;" in picture
    assert not re.search(r"20\d\d-|date", picture)
    widths = [float(one) for one in re.findall(r'class="bar" .*? width="([\d.]+)"', picture)]
    assert 0 < widths[0] < widths[1]


def test_the_more_cases_a_dot_stands_for_the_larger_it_is_and_what_is_right_stands_higher():
    picture = reliability("<Right>", "given", "right", [Dot(0.5, 0.25, 4), Dot(1.0, 1.0, 100)])

    found = re.findall(r'cx="([\d.]+)" cy="([\d.]+)" r="([\d.]+)"', picture)
    few, many = [tuple(map(float, one)) for one in found]
    assert few[0] < many[0]
    assert few[1] > many[1], "SVG counts downwards"
    assert few[2] < many[2]
    assert "&lt;Right&gt;" in picture


def test_confidence_is_counted_by_tenths_with_what_was_right():
    weighed = [(0.82, True), (0.88, False), (1.0, True), (0.0, False)]

    found = {one.id: (one.what, one.value, one.n) for one in calibrated(weighed)}

    assert found["calibration.given.8"] == ("0.8 to 0.9", 0.85, 2)
    assert found["calibration.right.8"] == ("0.8 to 0.9", 50.0, 2)
    assert found["calibration.right.9"] == ("0.9 to 1.0", 100.0, 1)
    assert found["calibration.right.0"] == ("0.0 to 0.1", 0.0, 1)
    assert len(found) == 9


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.0301, "0.030"),
        (0.814, "0.81"),
        (2.0, "2"),
        (54.51, "54.5"),
        (40752.9, "40,753"),
    ],
)
def test_numbers_have_three_digits_that_say_something(value, text):
    assert number(value) == text


@pytest.mark.parametrize("name", BENCHMARKS)
def test_every_benchmark_has_its_block_on_the_page_of_figures(name):
    page = (render.ROOT / "docs" / "figures.md").read_text()

    assert f"<!-- figures: {name} -->" in page
    assert (render.ROOT / f"{BENCHMARKS[name].module.replace('.', '/')}.py").exists()


@pytest.mark.parametrize("name", BENCHMARKS)
def test_a_block_has_every_figure_and_every_table_of_its_benchmark(name):
    block = render.block(name, read())

    for figure in read().run(name).figures:
        assert measured(figure) in block
        assert figure.table in block


def test_the_committed_results_can_be_read_and_hold_every_benchmark():
    assert set(read().runs) == set(BENCHMARKS)


def test_the_committed_front_table_can_be_read_and_holds_every_benchmark_of_it():
    assert set(read(FRONT_FILE).runs) <= set(FRONT)
    assert {one.benchmark for one in front.FRONT} == set(FRONT)


def test_the_readme_tells_the_machine_and_the_commit_of_its_one_run():
    told = front.measured_on(of_the_front(commit=("abc123", False)))

    assert told.startswith("Measured on Abacus, 2 cores")
    assert "commit `abc123`." in told
    assert "Not of one version" not in told


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        ({"commit": ("def456", False)}, "of 2 commits (abc123, def456)"),
        ({"commit": ("abc123", True)}, "of code that was in no commit (memory)"),
        ({"where": environment("Slide rule")}, "of 2 machines"),
    ],
)
def test_a_front_table_that_is_not_of_one_version_is_marked_with_why(more, reason):
    told = front.measured_on(with_run(of_the_front(), "memory", found(4.0), **more))

    assert "**Not of one version**" in told
    assert reason in told


def test_what_was_not_there_to_be_measured_is_named_below_the_table():
    shown = front.front(of_the_front())

    assert "start to ready" in shown
    assert "`image`" in shown.splitlines()[-1]


def of_the_front(**more):
    """Figures of `latency` as they are committed, measured otherwise."""
    figures = read(FRONT_FILE).run("latency").figures
    return with_run(Results(), "latency", Measured(figures=figures), **more)
