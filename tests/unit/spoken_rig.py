"""A conversation with a robot that goes to rooms until it is stopped; a listener speaks to it."""

from clocks import HeldClock
from fake_body import FakeBody
from waiting import Heard as Told

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.nlu.confidence import read_head
from edgevox.agent.nlu.decider import Decider
from edgevox.core.agent_events import AgentEvent
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, StopSpotted, TextInput, Transcribing
from edgevox.core.events import Responded, StateChanged, Transcribed, TurnEnded

AT_S = 50.0


class Certain:
    """An encoder for which every sentence is an order, without any doubt."""

    def features(self, text):
        head = read_head()
        weights = head.order_weights
        return (weights * (12.0 - head.order_bias) / float(weights @ weights)).astype("float32")


class Rig:
    """A conversation with a robot that goes to rooms until it is stopped, and what it tells."""

    def __init__(self, phonemes=None):
        self.bus, self.told, self.body = Bus(), Told(), FakeBody()
        for kind in (Responded, StateChanged, Transcribed, AgentEvent, TurnEnded):
            self.bus.subscribe(kind, self.told.add)
        self.conversation = Conversation(
            [Agent("robot", "Be brief.", self.body.skills("navigate_to"))],
            self.bus,
            halt=self.body.halt,
            clock=HeldClock(100.0),
            decider=Decider(Certain(), read_head()),
            phonemes=phonemes,
        )

    def of(self, kind):
        return [event for event in self.told.messages if isinstance(event, kind)]

    def answers(self):
        """All that was said but what a drive says itself."""
        return [one.text for one in self.of(Responded) if not one.text.startswith("Going")]

    def drive(self):
        self.conversation.submit(TextInput("go to the kitchen"))
        self.body.starts()
        self.told.wait_for(lambda event: isinstance(event, TurnEnded))

    def spot(self, *, goes_on=True):
        self.conversation.submit(StopSpotted(AT_S, "stop", goes_on=goes_on))

    def hear(self, text, ended_s=AT_S, **more):
        self.conversation.submit(Transcribing())
        self.conversation.submit(Heard(text, ended_s, **more))
        assert self.conversation.wait_idle(60)

    def hear_aside(self, text):
        """Words that nothing is done for, beside a drive."""
        self.conversation.submit(Heard(text, AT_S))
        self.told.wait_for(lambda event: isinstance(event, Responded) and event.turn > 1)
