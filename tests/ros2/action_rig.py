"""Both ends of `execute_skill`: a served conversation with a body to drive, and a client."""

import json

from action_msgs.msg import GoalStatus
from peer import done
from rclpy.action import ActionClient
from rclpy.qos import QoSProfile
from support.body import FakeBody
from support.conversation import Talk
from waiting import wait_until

from edgevox.core.clock import SystemClock
from edgevox.core.commands import TextInput
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.node import RosNode
from edgevox.ros2.skill_action import SkillAction
from edgevox_msgs.action import ExecuteSkill

BURST = QoSProfile(depth=100)
NAME = "/edgevox/execute_skill"
SKILLS = ("navigate_to", "open_door", "get_pose")
ENDS = {
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "canceled",
    GoalStatus.STATUS_ABORTED: "aborted",
}


class ActionRig(Talk):
    """A conversation whose skills are served as an action, and all that it published."""

    def __init__(self):
        super().__init__(FakeBody(reports=True), skills=SKILLS, clock=SystemClock())
        self.node = RosNode("/edgevox")
        backlog = Backlog(self.node.node, self.interlock)
        self.action = SkillAction(
            self.node.node, self.bus, self.conversation, ExecuteSkill, backlog=backlog
        )
        self.node.start()
        self.conversation.start()

    def close(self):
        self.conversation.close()
        self.action.close()
        self.node.close()

    def say(self, text):
        self.conversation.submit(TextInput(text))

    def driving(self):
        self.body.starts()

    def goals(self, skill_name):
        """How far the goals of a skill are."""
        goals = [one for one in self.events if one.get("skill") == skill_name and "status" in one]
        return [str(one["status"]) for one in goals if "feedback" not in one]


class Client:
    """An action client of a peer, whose answers can be waited for.

    Requests leave on the executor's thread, since rclpy misses an answer that is faster than its
    bookkeeping; and it keeps 100 answers, since its own 10 are fewer than a burst brings.
    """

    def __init__(self, peer, name=NAME):
        self._there = peer.there
        self._client = ActionClient(
            peer.node,
            ExecuteSkill,
            name,
            goal_service_qos_profile=BURST,
            result_service_qos_profile=BURST,
        )
        self.feedback = []
        wait_until(self._client.server_is_ready, name)

    def send(self, skill_name, arguments="", **keywords):
        """Ask for a goal; whether it was accepted is in the handle that comes back."""
        return self.send_all([(skill_name, arguments or json.dumps(keywords))])[0]

    def send_all(self, goals):
        """Ask for many goals at once, each a name and arguments as JSON; their handles."""
        messages = [ExecuteSkill.Goal(skill_name=n, arguments_json=a) for n, a in goals]
        return [done(future) for future in self.send_without_waiting(messages)]

    def send_without_waiting(self, messages):
        """Ask for goals; what to give to `done`, each."""
        return self._there(
            lambda: [self._client.send_goal_async(one, self._heard) for one in messages]
        )

    def ask_ends_of(self, handles):
        """Ask how goals end; what to give to `answer`, each."""
        return self._there(lambda: [handle.get_result_async() for handle in handles])

    def answer(self, future):
        """How a goal ended, with its result, once it has."""
        answer = done(future)
        return ENDS.get(answer.status, answer.status), answer.result

    def ends_of(self, handles):
        return [self.answer(future) for future in self.ask_ends_of(handles)]

    def end_of(self, handle):
        return self.ends_of([handle])[0]

    def cancel(self, handle):
        """Ask for its end; how many goals will be canceled."""
        return len(done(self._there(handle.cancel_goal_async)).goals_canceling)

    def cancel_without_waiting(self, handle):
        """Ask for its end, also of a server that does not answer now."""
        self._there(handle.cancel_goal_async)

    def destroy(self):
        """Leave the graph; a client that is only forgotten is still counted there.

        On the executor's thread, which may be taking something for it just now.
        """
        if self._client:
            self._there(self._client.destroy)
            self._client = None

    def _heard(self, message):
        self.feedback.append(json.loads(message.feedback.feedback_json))
