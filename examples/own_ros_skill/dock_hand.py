"""Two skills for any robot on ROS 2: one calls a service, one runs an action."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from pydantic import Field

from edgevox.agent.phrases.load import OwnPhrases
from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, skill
from edgevox.robots.node_handle import NodeHandle
from edgevox.robots.skill_packages import SkillContext

PHRASES = OwnPhrases(Path(__file__).parent / "dock_hand_phrases")
DOCKING_S = 120.0


def dock_hand_skills(context: SkillContext) -> Iterable[Skill]:
    """The entry point names this; EdgeVox calls it once, before the robot starts."""
    ros = context.require_ros()  # without ROS 2, these skills are off
    return [sound_horn_skill(ros), go_to_berth_skill(ros, context)]


def sound_horn_skill(ros: NodeHandle) -> Skill:
    """Make a skill that calls a service. Import message types here, where ROS 2 is there."""
    from std_srvs.srv import SetBool

    @skill(moves=False, phrases=PHRASES.of("sound_horn"))
    def sound_horn(goal: GoalHandle) -> Result:
        """Sound the horn once."""
        request = SetBool.Request(data=True)
        answer = ros.call(SetBool, "honk", request, token=goal.token, timeout_s=5.0)
        if not answer.success:
            raise SkillFailed(PHRASES.because("horn_silent"))
        return {}

    return sound_horn


def go_to_berth_skill(ros: NodeHandle, context: SkillContext) -> Skill:
    """Make a skill that runs an action, here of EdgeVox's own type."""
    from edgevox_msgs.action import ExecuteSkill

    @skill(phrases=PHRASES.of("go_to_berth"))
    def go_to_berth(goal: GoalHandle, berth: Annotated[int, Field(ge=1, le=9)] = 1) -> Result:
        """Go to a berth of the dock."""
        asked = ExecuteSkill.Goal(skill_name=f"berth {berth}")
        result = ros.run(
            ExecuteSkill,
            "dock",
            asked,
            token=goal.token,  # a stop cancels the action, too
            timeout_s=DOCKING_S,
            hear=lambda feedback: goal.report(**json.loads(feedback.feedback_json)),
        )
        context.log.info("berthed", berth=berth, answer=result.result_json)
        return {"berth": berth}

    return go_to_berth
