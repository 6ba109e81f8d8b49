"""Sends each command to the part that it is for."""

from edgevox.agent.conversation import Conversation
from edgevox.apps.queries import Queries
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Query, SetLanguage, SetMuted, SetVoice
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Answered


class CommandRouter:
    """Takes every command, from any thread; raises `InvalidValue` for one it cannot honour."""

    def __init__(
        self, conversation: Conversation, controls: Controls, queries: Queries, bus: Bus
    ) -> None:
        self._conversation = conversation
        self._controls = controls
        self._queries = queries
        self._bus = bus

    def submit(self, command: Command, mark: int | None = None) -> None:
        """Take a command, on the caller's thread: what a part other than the conversation does.

        The conversation dispatches the rest by when it is done, at once or in its turn
        (`Conversation.submit`), and what waited for its turn by what is done (its own thread).
        `mark` is the interlock's when the command was received, now by default.
        """
        match command:
            case SetLanguage(code=code):
                self._controls.change({"language": code.strip()})
            case SetVoice(name=name):
                self._controls.change({"voice": name.strip()})
            case SetMuted(muted=muted):
                self._controls.change({"muted": muted})
            case Query(name=name):
                if name not in self._queries:
                    raise InvalidValue("query", name, "one of " + ", ".join(self._queries))
                self._bus.publish(Answered(name, self._queries[name]()))
            case _:
                self._conversation.submit(command, mark)
