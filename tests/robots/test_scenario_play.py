"""`edgevox-agent ROBOT --scenario FILE`: its report, its exit code, and what it plays with."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from agent_here import run_agent
from guards import HUNG_S
from PIL import Image

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
VERDICT = re.compile(r"(PASS|FAIL) +(\d+) +([\d.]+) s +([\d.]+) s real  (.*)")


@pytest.fixture
def play(tmp_path, monkeypatch):
    for name in [name for name in os.environ if name.startswith("EDGEVOX_")]:
        monkeypatch.delenv(name)

    def run(text, *flags):
        file = tmp_path / "s.yaml"
        file.write_text(text)
        return run_agent("robot-apartment", "--scenario", str(file), *flags)

    return run


def verdicts(played):
    return [found[1] for found in VERDICT.finditer(played.stdout)]


def test_what_comes_true_is_reported_line_by_line_and_ends_with_0(play):
    played = play(
        "about: to the kitchen\n"
        "steps:\n"
        "  - say: go to the kitchen\n"
        "  - expect: {event: {skill: navigate_to, status: succeeded}, state: {room: kitchen}}\n"
        "    within: 60\n"
        "  - expect: {answer: I am in the kitchen}\n"
        "    within: 1\n"
    )
    assert played.returncode == 0, played.stdout + played.stderr
    first, *_, last = played.stdout.splitlines()
    assert first == "s.yaml on robot-apartment: to the kitchen"
    assert verdicts(played) == ["PASS"] * 3
    assert re.fullmatch(r"PASSED 3 steps, [\d.]+ s of the robot's time in [\d.]+ s", last)
    assert played.stderr == ""


def test_a_scenario_is_held_to_the_policy_that_it_names(play, tmp_path):
    policy = "limits: {places: {never: [bedroom]}, speed: {linear_m_s: 0.2}}"
    (tmp_path / "lobby.yaml").write_text(policy)
    played = play(
        "settings: {policy: lobby.yaml}\n"
        "never: [{state: {velocity.linear: {above: 0.21}}}]\n"
        "steps:\n"
        "  - say: go to the bedroom\n"
        "  - expect: {event: {status: rejected, code: policy_place, way: text_input}}\n"
        "  - expect: {answer: not permitted to go there}\n"
        "  - drive: {linear: 0.8, seconds: 1}\n"
        "  - say: go to the kitchen\n"
        "  - expect: {state: {room: kitchen}}\n"
        "    within: 60\n"
        "  - run: navigate_to\n"
        "    with: {room: bedroom}\n"
    )
    assert verdicts(played) == ["PASS"] * 6 + ["FAIL"], played.stdout
    assert "I am not permitted to go there: bedroom." in played.stdout


def test_what_does_not_come_true_in_time_ends_with_1_and_says_what_was_seen(play):
    played = play(
        "steps:\n"
        "  - say: go to the kitchen\n"
        "  - expect: {state: {room: kitchen}}\n"
        "    within: 1\n"
        "  - wait: 1\n"
    )
    assert played.returncode == 1
    assert verdicts(played) == ["PASS", "FAIL"]
    assert "expected room = 'kitchen'" in played.stdout
    assert "last seen: room = 'living_room', at 1.00 s" in played.stdout
    assert played.stdout.splitlines()[-1] == "FAILED at step 2 of 3"


def test_what_must_never_be_ends_it_at_the_moment_it_comes(play):
    played = play(
        "never:\n"
        "  - state: {velocity.linear: {above: 0.3}}\n"
        "steps:\n"
        "  - say: go to the kitchen\n"
        "  - wait: 30\n"
    )
    assert played.returncode == 1
    assert verdicts(played) == ["PASS", "FAIL"]
    assert "expected never velocity.linear > 0.3" in played.stdout
    assert float(VERDICT.findall(played.stdout)[-1][2]) < 2.0


def test_the_robots_time_stands_still_while_it_is_spoken_to(play):
    talk = "  - say: where are you\n" * 20
    played = play(f"steps:\n  - say: go to the bedroom\n{talk}  - wait: 0.5\n")
    assert played.returncode == 0
    assert [float(time) for _, _, time, _, _ in VERDICT.findall(played.stdout)][-2:] == [0.0, 0.5]


def test_two_runs_take_the_same_steps_at_the_same_times(play):
    text = (
        "steps:\n"
        "  - say: go to the office and then to the kitchen\n"
        "  - wait: 2\n"
        "  - drive: {linear: 0.2, angular: 1, seconds: 1}\n"
        "  - run: navigate_to\n"
        "    with: {room: office}\n"
        "  - expect: {event: {status: succeeded}}\n"
        "    within: 60\n"
    )
    one, other = (
        [float(found[3]) for found in VERDICT.finditer(play(text).stdout)] for _ in range(2)
    )
    assert one == pytest.approx(other, abs=0.1)
    assert len(one) == 5


def test_a_skill_that_is_refused_fails_the_step_with_the_reason(play):
    played = play("steps:\n  - run: fly\n")
    assert played.returncode == 1
    assert "skill: got 'fly', expected one of navigate_to" in played.stdout


def test_the_limit_of_real_time_ends_what_would_not(play):
    played = play("limit_s: 0.5\nsteps:\n  - wait: 3600\n")
    assert played.returncode == 1
    assert "it took longer than the limit of 0.5 real s" in played.stdout


@pytest.mark.parametrize(
    ("text", "flags", "said"),
    [
        ("steps:\n  - hop: 3\n", [], "s.yaml:2: steps.0"),
        ("agent: robot-panda\nsteps: [{wait: 1}]\n", [], "agent: got 'robot-apartment', expected"),
        ("settings: {language: xx}\nsteps: [{wait: 1}]\n", [], "language: got 'xx'"),
        ("settings: {world: no.yaml}\nsteps: [{wait: 1}]\n", [], "no.yaml"),
        ("steps: [{wait: 1}]\n", ["--snapshot", "/nowhere/at/all.png"], "snapshot: got"),
    ],
)
def test_what_is_wrong_in_a_file_ends_with_2_before_anything_happens(play, text, flags, said):
    played = play(text, *flags)
    assert played.returncode == 2
    assert said in played.stderr
    assert "Traceback" not in played.stderr


def test_settings_of_the_file_hold_and_the_command_line_overrules_them(play, tmp_path):
    (tmp_path / "hall.yaml").write_text(
        "world: {width: 8, height: 4}\n"
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 2, 0]}\n"
    )
    text = (
        "settings: {world: hall.yaml, language: de}\n"
        "steps:\n"
        "  - expect: {state: {pose.x: {near: 1, by: 0.01}}}\n"
        "  - run: navigate_xy\n"
        "    with: {x: 5, y: 2}\n"
        "  - wait: 1\n"
        "  - say: halt\n"
        "  - expect: {event: {kind: safety_preempt, word: halt}}\n"
    )
    assert play(text).returncode == 0
    assert play(text, "--language=de").returncode == 0
    assert play(text, "--world=nowhere.yaml").returncode == 2


def test_a_picture_of_the_end_can_be_had(play, tmp_path):
    file = tmp_path / "end.png"
    played = play("steps:\n  - wait: 1\n", "--snapshot", str(file))
    assert played.returncode == 0
    with Image.open(file) as image:
        assert image.format == "PNG"
    assert {one.name for one in tmp_path.iterdir()} == {"s.yaml", "end.png"}


def test_a_signal_ends_it_and_it_has_not_come_true(tmp_path):
    file = tmp_path / "s.yaml"
    file.write_text(
        "steps:\n  - say: go to the bedroom\n  - expect: {answer: never}\n    within: 3600\n"
    )
    playing = subprocess.Popen(
        [AGENT, "robot-apartment", "--scenario", str(file)], stdout=subprocess.PIPE, text=True
    )
    assert playing.stdout.readline()
    assert "PASS" in playing.stdout.readline()
    playing.terminate()
    rest, _ = playing.communicate(timeout=HUNG_S)
    assert playing.returncode == 1
    assert "PASSED" not in rest
