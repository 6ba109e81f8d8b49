"""A robot that is spoken to, as `edgevox-agent` builds it, in a world without real time."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet
from edgevox.apps.agent.policy import build_guard
from edgevox.apps.robots import build_body, open_places
from edgevox.core.agent_events import AgentEvent, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import ConversationCommand, RunSkill, TextInput
from edgevox.core.events import Responded
from edgevox.core.settings import check_settings


class SpokenRobot:
    """Its places are in the folder, and its policy, which `under` writes anew."""

    def __init__(
        self,
        folder: Path,
        robot: str = "robot-apartment",
        policy: str = "rules: {}",
        *,
        speed: float | None = None,
        language: str = "en",
        **more: Any,
    ) -> None:
        self._policy = folder / "policy.yaml"
        self.under(policy)
        settings = check_settings({"places": str(folder), "policy": str(self._policy), **more})
        self.body: Any = build_body(robot, settings, speed)
        open_places(self.body, settings)
        self.said: list[str] = []
        self.events: list[Mapping[str, Any]] = []
        self.bus = Bus()
        self.bus.subscribe(Responded, lambda event: self.said.append(event.text))
        self.bus.subscribe(AgentEvent, lambda event: self.events.append(as_json(event)))
        self.conversation = Conversation(
            [Agent(robot, "", SkillSet(self.body.skills))],
            self.bus,
            halt=self.body.halt,
            guard=build_guard(settings, self.bus, self.body),
            language=language,
        )

    def __enter__(self) -> Self:
        self.body.start()
        self.conversation.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.conversation.close()
        self.body.close()

    def under(self, policy: str) -> None:
        self._policy.write_text(policy)

    def told(self, key: str) -> list[str]:
        """What the events have of this."""
        return [str(event[key]) for event in self.events if event.get(key)]

    def say(self, *sentences: str) -> str:
        """Say them one after another; what is said last."""
        return self._submitted(*map(TextInput, sentences))

    def command(self, name: str, /, **arguments: object) -> str:
        """Run a skill as the topic `command` does; what is said last."""
        return self._submitted(RunSkill(name, arguments))

    def _submitted(self, *commands: ConversationCommand) -> str:
        for one in commands:
            self.conversation.submit(one)
            assert self.conversation.wait_idle(HUNG_S)
        return self.said[-1]


def trod(robot: SpokenRobot) -> set[str | None]:
    """The rooms that it was in."""
    return {robot.body.place_at(*point) for point in robot.body.trail()}
