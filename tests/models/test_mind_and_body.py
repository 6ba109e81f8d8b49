"""The whole mind with its real model, and a body that drives: in one process, without ROS 2."""

import threading

import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.base import LanguageModel
from edgevox.agent.llm.factory import load_model
from edgevox.agent.skills import SkillSet
from edgevox.apps.robots import build_agents
from edgevox.core.agent_events import AgentEvent, GoalChanged, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.events import Responded, RobotState, SentenceReady, TokenGenerated
from edgevox.models import locate
from edgevox.robots.apartment import ApartmentRobot

CHATTER = "Please tell me why the sky is blue and what you like about it."


@pytest.fixture(scope="module")
def mind_model():
    model = load_model(locate("qwen2.5-coder-0.5b-instruct"))
    yield model
    model.close()


class Home:
    """A robot at home, with everything it said and did."""

    def __init__(self, model: LanguageModel, agents=None):
        self.bus, self.events = Bus(), []
        for kind in (AgentEvent, Responded, RobotState, SentenceReady, TokenGenerated):
            self.bus.subscribe(kind, self.events.append)
        self.robot = ApartmentRobot()
        self.conversation = Conversation(
            agents(self.robot) if agents else build_agents(self.robot),
            self.bus,
            halt=self.robot.halt,
            model=model,
        )
        self.robot.start()
        self.conversation.start()

    def close(self):
        self.conversation.close()
        self.robot.close()

    def when(self, kind, condition=lambda event: True):
        happened = threading.Event()
        self.bus.subscribe(kind, lambda e: happened.set() if condition(e) else None)
        return happened

    def say(self, text):
        self.conversation.submit(TextInput(text))

    def deeds(self, kind):
        return [as_json(e) for e in self.events if isinstance(e, AgentEvent) and e.kind == kind]

    def answers(self):
        return [e for e in self.events if isinstance(e, Responded)]


@pytest.fixture
def home(mind_model):
    homes = []

    def make(**parts):
        homes.append(Home(mind_model, **parts))
        return homes[-1]

    yield make
    for one in homes:
        one.close()


def driving(event):
    return event.status == "running" and event.feedback["progress"] > 0.05


def drive_off(one, room="bedroom"):
    """The robot is on its way."""
    under_way = one.when(GoalChanged, lambda e: e.feedback is not None and driving(e))
    one.say(f"go to the {room}")
    assert under_way.wait(20)


def test_an_indirect_wish_moves_the_robot(home):
    one = home()
    one.say("I'd really appreciate it if you went to the kitchen now")
    assert one.conversation.wait_idle(90)
    (call,) = one.deeds("tool_call")
    assert (call["skill"], call["source"]) == ("navigate_to", "model")
    assert call["arguments"] == {"room": "kitchen"}
    assert one.robot.state()["room"] == "kitchen"
    assert one.answers()[-1].text == "I am in the kitchen."


def test_an_answer_streams_in_tokens_that_add_up_to_it(home):
    one = home()
    one.say("thank you, you are a good robot")
    assert one.conversation.wait_idle(60)
    tokens = [e.text for e in one.events if isinstance(e, TokenGenerated)]
    (answer,) = one.answers()
    assert len(tokens) > 2
    assert "".join(tokens).split() == answer.text.split()
    assert not one.deeds("tool_call")


def test_stop_halts_the_robot_while_the_model_is_busy(home):
    one = home()
    drive_off(one)
    thinking = one.when(TokenGenerated)
    one.say(CHATTER)
    assert thinking.wait(60)
    one.say("stop")
    assert one.robot.state()["goal"] is None
    one.robot.advance(0.12)
    assert one.robot.velocity().linear_m_s == pytest.approx(0, abs=0.01)
    assert one.conversation.wait_idle(30)
    assert one.answers()[-1].text == "Stopped."
    assert one.deeds("skill_cancelled")


def test_an_interrupt_cuts_the_answer_and_the_next_one_is_whole(home):
    one = home()
    thinking = one.when(TokenGenerated)
    one.say(CHATTER)
    assert thinking.wait(60)
    one.conversation.submit(Interrupt())
    assert one.conversation.wait_idle(30)
    tokens = len([e for e in one.events if isinstance(e, TokenGenerated)])
    assert tokens < 40
    one.say("thank you, you are a good robot")
    assert one.conversation.wait_idle(60)
    assert not one.answers()[-1].cut


def test_the_robot_is_asked_something_else_while_it_drives(home):
    one = home()
    drive_off(one)
    one.say("where are you")
    answered = one.when(Responded, lambda e: e.text.startswith("I am in the"))
    assert answered.wait(10) or one.answers()[-1].text.startswith("I am in the")
    assert one.robot.state()["goal"] is not None


def test_a_model_hands_over_to_the_agent_that_can_do_it(home):
    def two(robot):
        skills = SkillSet(robot.skills)
        talker = Agent("host", "You are a host who talks.", SkillSet(()), handoffs=("driver",))
        return [talker, Agent("driver", "You drive a robot.", skills, handoffs=("host",))]

    one = home(agents=two)
    one.say("let me speak with the driver please")
    assert one.conversation.wait_idle(120)
    assert one.deeds("handoff")[0] | {"turn": 1} == {"from": "host", "to": "driver", "turn": 1}
    assert one.conversation.mind.active.name == "driver"


def test_a_long_conversation_stays_within_the_context_window(home):
    one = home()
    for number in range(12):
        one.say(f"number {number}: " + "the weather was nice and we talked about it. " * 8)
        assert one.conversation.wait_idle(90)
    assert not [a for a in one.answers() if "language model failed" in a.text]
    assert len(one.answers()) == 12
