"""A conversation that asks back, with a robot that drives at once and a held clock."""

import threading
from dataclasses import replace

from clocks import HeldClock
from fake_body import FakeBody

from edgevox.agent.agents import Agent
from edgevox.agent.asking import Asking
from edgevox.agent.confirmation import OpenQuestion
from edgevox.agent.conversation import Conversation
from edgevox.agent.dialogue_skills import DialogueSkills
from edgevox.agent.last_drive import LastDrive
from edgevox.agent.nlu.confidence import ASK_FROM
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.performer import Performer
from edgevox.agent.programs.keeper import Programs
from edgevox.agent.skill_executor import SkillExecutor
from edgevox.agent.skills import SkillSet
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import Confirmation, ConfirmationStatus
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.events import Responded, TurnEnded

SKILLS = ("navigate_to", "walk_forward", "dance", "get_pose", "stop")


class Heard:
    """What was asked and said, of everything on a bus."""

    def __init__(self, bus):
        self.questions, self.answers, self.outcomes = [], [], []
        self.ended = threading.Event()
        bus.subscribe(Confirmation, self._on_question)
        bus.subscribe(Responded, lambda event: self.answers.append(event.text))
        bus.subscribe(TurnEnded, lambda event: self.outcomes.append(event.outcome))

    def _on_question(self, event):
        self.questions.append(event)
        if event.status is not ConfirmationStatus.ASKED:
            self.ended.set()

    @property
    def statuses(self):
        return [str(one.status) for one in self.questions]


class Eloquent:
    """A language model with room for what was said, which nobody asks here."""

    name, context_tokens = "eloquent", 4096

    def count_tokens(self, text):
        return len(text.split())


class Talk(Heard):
    """A whole conversation, as anybody submits to it."""

    def __init__(self, confirm="always", language="en", speech_output=None, model=None):
        self.bus, self.clock, self.body = Bus(), HeldClock(100.0), FakeBody(arrives=True)
        super().__init__(self.bus)
        self.conversation = Conversation(
            [Agent("robot", "Be brief.", self.body.skills(*SKILLS))],
            self.bus,
            halt=self.body.halt,
            language=language,
            confirm=confirm,
            clock=self.clock,
            speech_output=speech_output,
            model=model,
        )

    def __enter__(self):
        self.conversation.start()
        return self

    def __exit__(self, *_):
        self.body.arrive()
        self.conversation.close()

    def say(self, *texts):
        for text in texts:
            self.conversation.submit(TextInput(text))
            assert self.conversation.wait_idle(60)


class Doubtful(Interpreter):
    """Is as sure of what it understands as the test says; what a model calls is `filled_in`."""

    confidence = 1.0
    filled_in = ()

    def understand(self, text, turn):
        if self.filled_in:
            return Meaning(self.active, tuple(self.filled_in), "model", ASK_FROM)
        meaning = super().understand(text, turn)
        return replace(meaning, confidence=self.confidence) if meaning else None


class Doubts(Heard):
    """What decides to act or to ask, alone, with an interpreter that is not sure."""

    def __init__(self, confirm="unsure", confidence=0.6, guard=None, skills=()):
        self.bus, self.clock, self.turns = Bus(), HeldClock(100.0), 0
        self.body = FakeBody(arrives=True)
        super().__init__(self.bus)
        self.executor = SkillExecutor(
            self.bus, self.body.halt, lambda text, detail: None, guard=guard
        )
        known = SkillSet([*self.body.skills(*SKILLS).values(), *skills])
        agent = Agent("robot", "Be brief.", known)
        dialogue_skills = DialogueSkills(
            [agent], self.bus, self.clock, lambda: self.interpreter.phrases
        )
        interpreter = Doubtful(dialogue_skills.agents, self.bus, self.clock)
        interpreter.confidence = confidence
        self.interpreter = interpreter
        programs = Programs(
            self.bus,
            self.executor,
            agent.skills,
            announce=lambda text: None,
            phrases=lambda: interpreter.phrases,
            clock=self.clock,
        )
        last = LastDrive(self.bus, self.clock)
        performer = Performer(interpreter, self.executor, programs, dialogue_skills, last)
        question = OpenQuestion(self.bus, self.clock)
        self.asking = Asking(interpreter, performer, dialogue_skills, question, confirm=confirm)

    def __enter__(self):
        self.executor.start()
        return self

    def __exit__(self, *_):
        self.executor.close()

    def new_turn(self):
        self.turns += 1
        return Turn(self.turns, self.bus, self.clock, lambda: None)

    def say(self, text):
        turn = self.new_turn()
        self.asking.attend(text, turn, self.clock.now())
        turn.finish(measured=False)
        self.asking.question.said(turn)
        assert self.executor.wait_idle(60)
        return turn
