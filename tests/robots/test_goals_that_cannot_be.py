"""Before a goal is accepted, every body refuses numbers that no goal of its can have."""

from collections.abc import Callable, Mapping

import phrases
import pytest
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillFailed, SkillSet
from edgevox.core.agent_events import AgentEvent, AgentEventKind
from edgevox.core.bus import Bus
from edgevox.core.commands import RunSkill, TextInput
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import Outcome, Responded, TurnEnded
from edgevox.core.transforms import Pose2D
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.flat.irsim import IrsimRobot
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.panda.skills import manipulation_skills
from edgevox.robots.relative_skills import walking_skills
from edgevox.ros2.external.robot import ExternalRobot
from edgevox.ros2.external.settings import Location


class Edgeless:
    """A body of a stranger, that does not say where its world ends, and moves for nobody."""

    name = "edgeless"
    places: Mapping[str, tuple[float, float]] = {}

    def pose(self) -> Pose2D:
        return Pose2D(0.0, 0.0, 0.0)


BODIES: Mapping[str, Callable[[], SkillSet]] = {
    "apartment": lambda: SkillSet(ApartmentRobot().skills),
    "irsim": lambda: SkillSet(IrsimRobot().skills),
    "external": lambda: SkillSet(ExternalRobot("/", {"dock": Location(0.0, 0.0)}).skills),
    "edgeless": lambda: SkillSet(navigation_skills(Edgeless())),  # type: ignore[arg-type]
    "panda": lambda: SkillSet(manipulation_skills(Edgeless())),  # type: ignore[arg-type]
    "humanoid": lambda: SkillSet(walking_skills(Edgeless())),  # type: ignore[arg-type]
}
NOT_THAT_BODY = {
    "navigate_xy": ("apartment", "irsim", "external", "edgeless"),
    "move_to": ("panda",),
    "walk_forward": ("humanoid",),
    "turn_left": ("humanoid",),
}
POINT = {"navigate_xy": {"x": 1.0, "y": 1.0}, "move_to": {"x": 0.4, "y": 0.0, "z": 0.3}}
FIRST = {"navigate_xy": "x", "move_to": "z", "walk_forward": "distance", "turn_left": "degrees"}
CASES = [(body, skill) for skill, bodies in NOT_THAT_BODY.items() for body in bodies]


def conversation(body: str) -> Conversation:
    return Conversation([Agent("robot", "", BODIES[body]())], Bus(), halt=lambda _: False)


@pytest.mark.parametrize(("body", "skill"), CASES)
@pytest.mark.parametrize("far", [1e308, -1e308, 1e18, -1e7, 10**400])
def test_a_number_far_outside_the_world_is_refused_with_a_reason(body, skill, far) -> None:
    arguments = POINT.get(skill, {}) | {FIRST[skill]: far}

    with pytest.raises(EdgeVoxError) as refused:
        conversation(body).check_goal(skill, arguments)

    assert isinstance(refused.value, InvalidValue | SkillFailed)
    assert str(refused.value)


@pytest.mark.parametrize(("body", "skill"), CASES)
@pytest.mark.parametrize(
    "wrong",
    [True, False, "5", "5 metres", "", None, [5], {"value": 5}, float("nan"), float("inf")],
    ids=repr,
)
def test_what_is_no_number_is_refused_by_its_name(body, skill, wrong) -> None:
    arguments = POINT.get(skill, {}) | {FIRST[skill]: wrong}

    with pytest.raises(InvalidValue) as refused:
        conversation(body).check_goal(skill, arguments)

    assert refused.value.field == f"{skill}.{FIRST[skill]}"


@pytest.mark.parametrize(("body", "skill"), CASES)
def test_a_whole_number_is_a_number(body, skill) -> None:
    arguments = {"navigate_xy": {"x": 1, "y": 1}, "move_to": {"x": 0, "y": 0, "z": 1}}

    conversation(body).check_goal(skill, arguments.get(skill, {FIRST[skill]: 2}))


@pytest.mark.parametrize(
    ("body", "x", "y"),
    [("apartment", 10.5, 1.0), ("irsim", 1.0, -0.5), ("external", 10_001.0, 0.0)],
)
def test_a_point_right_outside_the_world_is_refused_with_the_worlds_edges(body, x, y) -> None:
    with pytest.raises(SkillFailed, check=phrases.because("outside")):
        conversation(body).check_goal("navigate_xy", {"x": x, "y": y})


def test_a_sentence_that_asks_for_such_a_point_is_refused_before_it_is_acknowledged() -> None:
    bus, said, ended = Bus(), [], []
    bus.subscribe(Responded, lambda event: said.append(event.text))
    bus.subscribe(TurnEnded, lambda event: ended.append(event.outcome))
    bus.subscribe(AgentEvent, lambda event: said.append(event.kind))
    talk = Conversation([Agent("robot", "", BODIES["apartment"]())], bus, halt=lambda _: False)
    talk.start()
    try:
        talk.submit(TextInput("go to x 50, y 2"))
        talk.submit(RunSkill("navigate_xy", {"x": True, "y": 1}))
        assert talk.wait_idle(HUNG_S)
    finally:
        talk.close()
    edges = {"x_min": "0", "x_max": "10", "y_min": "0", "y_max": "10"}
    assert said == [
        AgentEventKind.SKILL_GOAL,  # that it is rejected
        phrases.failed("outside", place="apartment", **edges),
        AgentEventKind.SKILL_GOAL,
        phrases.refused("no_number", argument="x", value="True"),
    ]
    assert ended == [Outcome.REFUSED, None]
