"""Two skills for any robot on ROS 2: one calls a service, one runs an action."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from pydantic import Field

from edgevox.agent.phrases.own_phrases import OwnPhrases
from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, skill
from edgevox.robots.node_handle import NodeHandle
from edgevox.robots.skill_packages import SkillContext

PHRASES = OwnPhrases(Path(__file__).parent / "dock_hand_phrases")
DOCKING_S = 120.0


def dock_hand_skills(context: SkillContext) -> Iterable[Skill]:
    """What the entry point names: called once, before the robot is started."""
    ros = context.require_ros()  # where there is none, these skills are off
    return [sound_horn_skill(ros), go_to_berth_skill(ros, context)]


def sound_horn_skill(ros: NodeHandle) -> Skill:
    """Calls a service. Types are imported here, where it is known that there is ROS 2."""
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
    """Runs an action, here of the type by which EdgeVox runs its own skills."""
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
