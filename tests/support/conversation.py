"""The one rig of a conversation: a body to talk to, all that comes of it, and time that is held."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from guards import HUNG_S
from waiting import Heard as Told

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.known import Known
from edgevox.agent.nlu.decider import Decider
from edgevox.agent.nlu.head import KindHead, read_head
from edgevox.agent.nlu.meaning import ASK_FROM, Meaning
from edgevox.agent.policy import Guard
from edgevox.agent.skills import Call, Skill, SkillSet
from edgevox.core.agent_events import AgentEvent, Confirmation, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import ConversationCommand, Heard, Hypothesis, Reset, TextInput, Way
from edgevox.core.events import (
    Decided,
    Responded,
    StateChanged,
    TokenGenerated,
    Transcribed,
    TurnEnded,
    TurnMeasured,
)
from edgevox.core.motion.interlock import Interlock
from edgevox.core.settings import Confirm
from support.body import FakeBody
from support.clock import HeldClock

SKILLS = ("navigate_to", "walk_forward", "dance", "get_pose", "stop")
BACK = Call("navigate_xy", {"x": 1.0, "y": 2.0})
"""The way back of a program, such as "go to the kitchen and back"."""
TOLD = (
    AgentEvent | Decided | Responded | StateChanged | TokenGenerated | Transcribed | TurnEnded
) | TurnMeasured


def LETTERS(text: str, _code: str) -> str:  # noqa: N802 - stands for an engine
    """Letters for phonemes: near enough, and the same on every machine."""
    return text.replace("th", "ð").replace("ch", "ʃ")


ORDER, TALK = 12.0, -12.0
"""Logits of the head for what is surely an order, and for what is surely none."""


def _first_of(head: KindHead) -> list[float]:
    """Logits of the first kind alone; the weights of all kinds add up to 0."""
    others = len(head.kinds) - 1
    return [float(others), *[-1.0] * others]


class CertainEncoder:
    """An encoder whose every sentence gives the head the same logit: that of an order.

    By the other regressions it is a remark that asks for nothing, and wants what it says now.
    """

    def __init__(self, logit: float = ORDER) -> None:
        head = read_head()
        kinds = head.talk, head.asked, head.told, head.meant
        weights = [one.weights for one in kinds]
        biases = [one.biases for one in kinds]
        self._features = np.linalg.lstsq(
            np.vstack([head.order_weights, head.general_weights, *weights]),
            np.hstack([logit, TALK, *map(_first_of, kinds)])
            - np.hstack([head.order_bias, head.general_bias, *biases]),
        )[0]

    def features(self, text: str) -> Any:
        return self._features.astype("float32")


class Eloquent:
    """A language model that says the same to everything, or what one made of it says."""

    name, context_tokens = "eloquent", 4096

    def __init__(self, *pieces: str) -> None:
        self._pieces = pieces

    def generate(self, messages: Any, *, grammar: Any, max_tokens: int, token: Any) -> Any:
        yield from self._pieces

    def prime(self, messages: Any, token: Any) -> None:
        """Nothing to read."""

    def count_tokens(self, text: str) -> int:
        return len(text.split())

    def close(self) -> None:
        """Nothing to free."""


class Talk:
    """A conversation with a body that arrives at once, unless it is another one.

    `skills` are what it can be asked for, names of the body's or skills of one's own. `certain`
    decides as if every sentence were an order, `hears` tells what misheard words sound like.
    `policy` is the file of a policy, `facts` are what the body tells. Everything else is the
    conversation's.
    """

    def __init__(
        self,
        body: FakeBody | None = None,
        *,
        skills: Sequence[str] | SkillSet = SKILLS,
        agents: Sequence[Agent] | None = None,
        confirm: Confirm = "unsure",
        policy: Path | None = None,
        battery: bool = True,
        certain: bool = False,
        hears: bool = False,
        facts: tuple[Skill, ...] = (),
        **more: Any,
    ) -> None:
        self.bus, self.clock, self.interlock = Bus(), HeldClock(1000.0), Interlock()
        self.guard = Guard(policy, self.bus)
        clock = more.pop("clock", self.clock)
        self.body = body or FakeBody(arrives=True)
        self._told = Told[Any]()
        self.bus.subscribe(TOLD, self._told.add)
        self.skills = skills if isinstance(skills, SkillSet) else self.body.skills(*skills)
        if certain:
            more["decider"] = Decider(CertainEncoder(), read_head())
        if hears:
            more["phonemes"] = LETTERS
        self.conversation = Conversation(
            agents or [Agent("robot", "Be brief.", self.skills)],
            self.bus,
            halt=self.body.halt,
            confirm=confirm,
            clock=clock,
            interlock=self.interlock,
            guard=self.guard,
            known=Known(
                facts=facts,
                pose=self.body.pose,
                battery=(lambda: self.body.battery) if battery else None,
                way_back=lambda: BACK if BACK.skill in self.skills else None,
            ),
            timer=self.clock,
            **more,
        )

    def __enter__(self) -> Self:
        self.conversation.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.body.arrive()
        self.conversation.close()

    def start_over(self, confirm: Confirm = "unsure") -> None:
        """As if nothing had been said; only its ears and its language stay as they are."""
        self.conversation.submit(Reset())
        self.settle()
        self.conversation.set_confirm(confirm)
        self.body.start_over()

    # What is said to it.

    def say(self, *texts: str) -> str:
        """The first that is answered to the last of these, once everything has ended."""
        answers = [self.answers_to(TextInput(text)) for text in texts]
        return answers[-1][0].text if answers[-1] else ""

    def hear(
        self, text: str, ended_s: float | None = None, *, others: Sequence[Any] = (), **more: Any
    ) -> str:
        """The same for words that are spoken; `others` is what else may have been said."""
        at_s = self.clock.now() if ended_s is None else ended_s
        instead = tuple(Hypothesis(*one) for one in others)
        answers = self.answers_to(Heard(text, at_s, others=instead, **more))
        return answers[0].text if answers else ""

    def ask(self, text: str, way: Way = Way.TEXT_INPUT) -> str:
        """The first that is answered, though the body may go on."""
        return self.first_answer(TextInput(text, way)).text

    def begin(self, text: str) -> str:
        """The same, once a drive has begun that goes on until the body may `arrive`."""
        self.body.drive_on()
        begun, turns = len(self.body.sent), len(self.of(TurnEnded))
        answer = self.ask(text)
        self.body.starts_until(begun + 1)
        self.until(lambda: len(self.of(TurnEnded)) > turns)
        return answer

    def answers_to(self, command: ConversationCommand) -> list[Responded]:
        """All that is said, once everything has ended."""
        before = len(self.of(Responded))
        self.conversation.submit(command)
        self.settle()
        return self.of(Responded)[before:]

    def first_answer(self, command: ConversationCommand) -> Responded:
        before = len(self.of(Responded))
        self.conversation.submit(command)
        self.until(lambda: len(self.of(Responded)) > before)
        return self.of(Responded)[before]

    # How it understands: instead of what it would.

    def doubt(self, confidence: float) -> Self:
        """Be as sure as this of whatever is understood."""
        understand = self.conversation.interpreter.understand

        def doubtful(text: str, turn: Any) -> Meaning | None:
            meaning = understand(text, turn)
            return replace(meaning, confidence=confidence) if meaning else None

        self.conversation.interpreter.understand = doubtful
        return self

    def mean(self, *calls: Call, source: str = "reading", confidence: float = ASK_FROM) -> Self:
        """Understand these calls, whatever is said."""
        active = self.conversation.interpreter.active
        self.conversation.interpreter.understand = lambda text, turn: Meaning(
            active, calls, source, confidence
        )
        return self

    # What came of it.

    def of(self, *kinds: Any, since: int = 0) -> list[Any]:
        """The events of these kinds, in their order; `since` so many of all kinds were told."""
        return [one for one in self._told.messages[since:] if isinstance(one, kinds)]

    @property
    def count(self) -> int:
        """How many events have been told."""
        return len(self._told.messages)

    @property
    def said(self) -> list[str]:
        return [one.text for one in self.of(Responded)]

    @property
    def questions(self) -> list[Confirmation]:
        return self.of(Confirmation)

    @property
    def statuses(self) -> list[str]:
        """What became of the questions."""
        return [str(one.status) for one in self.questions]

    @property
    def programs(self) -> list[str]:
        """What became of programs."""
        return [str(one["status"]) for one in self.told("program")]

    @property
    def outcomes(self) -> list[Any]:
        return [one.outcome for one in self.of(TurnEnded)]

    @property
    def events(self) -> list[Mapping[str, Any]]:
        """What programs get, as JSON."""
        return [as_json(one) for one in self.of(AgentEvent)]

    def told(self, kind: str) -> list[Mapping[str, Any]]:
        """The same of one kind."""
        return [one for one in self.events if one["kind"] == kind]

    # Waiting.

    def settle(self) -> None:
        """Until everything has ended."""
        assert self.conversation.wait_idle(HUNG_S), "it never ends"

    def until(self, true: Callable[[], object]) -> None:
        """Until this is true, which some event makes it."""
        self._told.wait_until(true)

    def until_said(self, text: str) -> None:
        self.until(lambda: text in self.said)

    def ended(self) -> None:
        """Until no program is kept, and nothing moves."""
        self.until(lambda: not self.conversation.programs.kept)
        self.settle()


def drives(**more: Any) -> Talk:
    """A conversation with a robot that drives between four rooms as long as the test wants."""
    body = FakeBody(rooms=("kitchen", "office", "bedroom", "dock"))
    return Talk(body, skills=("navigate_to", "navigate_xy", "stop", "get_pose"), **more)
