"""The whole interpreter with a real model, and a body that drives: in one process, without ROS 2.

What the model of the set `small` answers is in `test_words`. The robot drives as fast as it can be
computed, or in a world whose time the test holds (speed 0).
"""

import threading

import phrases
import pytest
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.factory import load_model
from edgevox.agent.llm.language_model import LanguageModel
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.skills import SkillSet
from edgevox.apps.robots import build_agents
from edgevox.core.agent_events import AgentEvent, GoalChanged, HandedOver, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import Interrupt, TextInput
from edgevox.core.events import Responded, RobotState, SentenceReady, TokenGenerated
from edgevox.robots.flat.apartment import ApartmentRobot

CHATTER = "what is the capital of Norway?"
TIGHT_TOKENS = 1536
"""A context in which instructions and an answer leave room for an exchange or two."""
TURNS = 12
"""More than fit into that."""


def talker(robot):
    """It drives, and talks; the model has little to read of that."""
    skills = SkillSet(one for one in robot.skills if one.name == "navigate_to")
    return [Agent("talker", "You drive a robot, and talk.", skills)]


@pytest.fixture
def tight(tiny_path, threads):
    model = load_model(tiny_path, context_tokens=TIGHT_TOKENS, threads=threads)
    yield model
    model.close()


class Home:
    """A robot at home, with everything it said and did."""

    def __init__(self, model: LanguageModel, decider: Decider, agents=None, speed=None):
        self.bus, self.events = Bus(), []
        for kind in (AgentEvent, Responded, RobotState, SentenceReady, TokenGenerated):
            self.bus.subscribe(kind, self.events.append)
        self.robot = ApartmentRobot(speed=speed)
        self.conversation = Conversation(
            agents(self.robot) if agents else build_agents(self.robot),
            self.bus,
            halt=self.robot.halt,
            model=model,
            decider=decider,
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

    def talk(self, text):
        """Say this, and wait for all that comes of it."""
        self.say(text)
        assert self.conversation.wait_idle(HUNG_S)

    def agent_events(self, kind):
        return [as_json(e) for e in self.events if isinstance(e, AgentEvent) and e.kind == kind]

    def answers(self):
        return [e for e in self.events if isinstance(e, Responded)]


@pytest.fixture
def home(tiny, decider):
    homes = []

    def make(model=tiny, **parts):
        homes.append(Home(model, decider, **parts))
        return homes[-1]

    yield make
    for one in homes:
        one.close()


def drive_off(one, room="bedroom"):
    """The robot is on its way, in a world whose time is held."""
    under_way = one.when(GoalChanged, lambda e: e.feedback is not None)
    one.say(f"go to the {room}")
    assert under_way.wait(HUNG_S)
    one.robot.advance(2.0)
    assert one.robot.velocity().linear_m_s > 0.1


def test_an_indirect_wish_moves_the_robot(home):
    one = home()
    one.talk("I would like you over in the kitchen, please")
    (call,) = one.agent_events("tool_call")
    assert (call["skill"], call["source"]) == ("navigate_to", "reading")
    assert call["arguments"] == {"room": "kitchen"}
    assert one.robot.state()["room"] == "kitchen"
    assert one.answers()[-1].text == phrases.done("navigate_to", room="kitchen")


def test_a_wish_that_it_is_less_sure_of_is_asked_about_first(home):
    one = home()
    one.talk("would you fancy going into the kitchen")
    assert one.answers()[-1].text == phrases.asks("navigate_to", room="kitchen")
    assert not one.agent_events("tool_call")
    one.talk("yes, please")
    assert one.robot.state()["room"] == "kitchen"


@pytest.mark.parametrize("said", ["what is seven times eight", "I was in the office yesterday"])
def test_what_nobody_asked_for_moves_nothing(home, said):
    one = home(agents=talker)
    one.talk(said)
    assert one.answers()
    assert not one.agent_events("tool_call")


def test_an_answer_streams_in_tokens_that_add_up_to_it(home):
    one = home(agents=talker)
    one.talk(CHATTER)
    tokens = [e.text for e in one.events if isinstance(e, TokenGenerated)]
    (answer,) = one.answers()
    assert len(tokens) > 2
    assert "".join(tokens).split() == answer.text.split()
    assert not one.agent_events("tool_call")


def test_stop_halts_the_robot_while_the_model_is_busy(home):
    one = home(agents=talker, speed=0.0)
    drive_off(one)
    thinking = one.when(TokenGenerated)
    one.say(CHATTER)
    assert thinking.wait(HUNG_S)
    one.say("stop")
    assert one.robot.state()["goal"] is None
    one.robot.advance(0.12)
    assert one.robot.velocity().linear_m_s == pytest.approx(0, abs=0.01)
    assert one.conversation.wait_idle(HUNG_S)
    assert one.answers()[-1].text == phrases.said("stopped")
    assert one.agent_events("skill_cancelled")


def test_an_interrupt_cuts_the_answer_and_the_next_one_is_whole(home):
    one = home(agents=talker)
    thinking, interrupted = one.when(TokenGenerated), threading.Event()
    one.bus.subscribe(TokenGenerated, lambda _: interrupted.wait(HUNG_S))
    one.say(CHATTER)
    assert thinking.wait(HUNG_S)
    one.conversation.submit(Interrupt())
    interrupted.set()
    assert one.conversation.wait_idle(HUNG_S)
    assert len([e for e in one.events if isinstance(e, TokenGenerated)]) <= 2
    one.talk(CHATTER)
    assert not one.answers()[-1].cut


def test_the_robot_is_asked_something_else_while_it_drives(home):
    one = home(speed=0.0)
    drive_off(one)
    answered = one.when(Responded, lambda e: e.text.startswith("I am in the"))
    one.say("where are you")
    assert answered.wait(HUNG_S)
    assert one.robot.state()["goal"] is not None


@pytest.mark.long
def test_a_model_hands_over_to_the_agent_that_can_do_it(home, small):
    def two(robot):
        skills = SkillSet(one for one in robot.skills if one.name == "navigate_to")
        talker = Agent("host", "You are a host who talks.", SkillSet(()), handoffs=("driver",))
        return [talker, Agent("driver", "You drive a robot.", skills, handoffs=("host",))]

    one = home(model=small, agents=two)
    handed_over = one.when(HandedOver)
    one.say("let me speak with the driver please")
    assert handed_over.wait(HUNG_S)
    one.conversation.submit(Interrupt())  # what the other one reads and answers is not waited for
    assert one.conversation.wait_idle(HUNG_S)
    assert HandedOver("host", "driver", turn=1) in one.events
    assert one.conversation.interpreter.active.name == "driver"


@pytest.mark.long
def test_a_long_conversation_stays_within_the_context_window(home, tight):
    one = home(model=tight, agents=lambda _: [Agent("talker", "You talk.")])
    for number in range(TURNS):
        one.talk(f"number {number}: " + "why does ice float on water, and why do ships? " * 6)
    known = [message.content for message in one.conversation.interpreter.chat()]
    assert not any("number 0:" in said for said in known), "it was too short to forget anything"
    assert any(f"number {TURNS - 1}:" in said for said in known)
    assert not [a for a in one.answers() if "language model failed" in a.text]
    assert len(one.answers()) == TURNS
