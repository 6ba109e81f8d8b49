"""A fall is noticed and said, nothing is done lying down, and it gets up when it is told."""

from dataclasses import replace

import phrases
import pytest
from humanoid_rig import apart, g1, stand, turned_deg, walk, walking

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.humanoid import (
    FunctionPolicy,
    HumanoidRobot,
    MujocoHumanoidEnvironment,
    Observation,
    WalkingCommand,
)

SHOVE_N = 900.0


@pytest.fixture
def environment() -> MujocoHumanoidEnvironment:
    return g1()


@pytest.fixture
def robot(environment, held) -> HumanoidRobot:
    """Its time stands still until it is told."""
    return held(HumanoidRobot, environment)


def shove(robot: HumanoidRobot, environment: MujocoHumanoidEnvironment) -> None:
    """From the left, for a fifth of a second; then it falls for two seconds."""
    torso = environment.model.body("torso_link").id
    environment.data.xfrc_applied[torso, 1] = -SHOVE_N
    robot.advance(0.2)
    environment.data.xfrc_applied[torso, 1] = 0.0
    robot.advance(2.0)


def test_a_walk_fails_with_a_reason_when_it_is_pushed_over(robot, environment) -> None:
    going = walking(robot, 3.0)
    robot.advance(1.5)

    shove(robot, environment)

    error = going.ended()
    assert isinstance(error, SkillFailed)
    assert error.reason.code == "fallen"
    state = robot.state()
    assert state["fallen"] is True
    assert state["activity"] == "fallen"
    assert state["height"] < 0.4
    assert state["goal"] is None


def test_lying_on_the_floor_it_refuses_to_walk_and_follows_no_velocity(robot, environment) -> None:
    shove(robot, environment)
    before = robot.pose()

    with pytest.raises(SkillFailed, check=phrases.because("fallen")):
        walk(robot, 1.0)
    for _ in range(20):
        robot.set_velocity(Twist2D(0.5, 0.5))
        robot.advance(0.1)

    assert apart(before, robot.pose()) < 0.1
    assert robot.state()["fallen"] is True


def test_told_to_stand_it_is_put_upright_where_it_lies_and_walks_on(environment) -> None:
    with HumanoidRobot(environment, speed=None) as robot:
        shove(robot, environment)
        lying = robot.pose()

        assert stand(robot) is True

        assert robot.state()["fallen"] is False
        assert apart(lying, robot.pose()) < 0.1
        assert abs(turned_deg(lying, robot.pose())) < 10
        before = robot.pose()
        walk(robot, 0.5)
        assert apart(before, robot.pose()) == pytest.approx(0.5, abs=0.1)
        assert stand(robot) is False


def test_the_skill_says_that_the_simulator_put_it_up(environment) -> None:
    with HumanoidRobot(environment, speed=None) as robot:
        shove(robot, environment)
        skill = next(one for one in robot.skills if one.name == "stand")

        result = skill.function(_Goal(), **skill.validate({}))

    assert result["got_up"] is True
    assert "put me on my feet" in phrasebook("en").report(skill, {}, result)


def test_reset_gets_it_up_too(robot, environment) -> None:
    shove(robot, environment)

    robot.reset()
    robot.advance(1.0)

    assert robot.state()["fallen"] is False
    assert robot.state()["height"] > 0.7


def test_a_state_that_is_no_number_is_put_right_and_counted(
    robot, environment, tmp_path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes a log there
    robot.advance(0.1)
    environment.data.qvel[:] = float("nan")

    robot.advance(1.0)

    assert robot.breaks >= 1
    assert robot.state()["height"] > 0.7


def test_a_policy_of_ones_own_sees_and_moves_every_joint(environment) -> None:
    seen: list[Observation] = []
    plan = environment.policy.plan
    stiff = replace(plan, stiffness=10 * plan.stiffness, damping=10 * plan.damping)

    def keep_still(observation: Observation):
        seen.append(observation)
        return plan.stand_rad

    environment.set_walking_policy(FunctionPolicy(stiff, keep_still, "keep still"))
    environment.step(WalkingCommand(0.5))

    assert environment.gait == "keep still"
    assert environment.simulation == "physics"
    assert seen[0].angles_rad.shape == seen[0].speeds_rad_s.shape == plan.stand_rad.shape
    assert seen[0].gravity == pytest.approx([0, 0, -1], abs=0.1)
    assert seen[0].command.stands
    assert seen[-1].command.forward_m_s > 0


def test_a_policy_that_falls_before_it_was_asked_for_anything_is_refused(environment) -> None:
    plan = environment.policy.plan
    weak = replace(plan, stiffness=0.1 * plan.stiffness)

    with pytest.raises(InvalidValue, match="policy: got 'faint', expected a walking policy that"):
        environment.set_walking_policy(FunctionPolicy(weak, lambda _: plan.stand_rad, "faint"))


class _Goal:
    def __init__(self) -> None:
        self.token = CancelToken()

    def report(self, **feedback: object) -> None: ...
