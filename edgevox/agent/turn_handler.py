"""What is done in a turn, by what began it: words are conversed about, all else is one step."""

from typing import assert_never

from edgevox.agent import inbox
from edgevox.agent.asking import Asking
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.skill_executor import SkillExecutor
from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.states import StateMachine
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, RunSkill, Speak, TextInput
from edgevox.core.events import Outcome, State, Transcribed
from edgevox.core.log import get_logger
from edgevox.core.text import MAX_CHARACTERS, clean

log = get_logger(__name__)


class TurnHandler:
    """Used from the conversation's thread. `skills` are those of all agents."""

    def __init__(
        self,
        bus: Bus,
        interpreter: Interpreter,
        asking: Asking,
        *,
        executor: SkillExecutor,
        skills: SkillSet,
        states: StateMachine,
    ) -> None:
        self._bus = bus
        self._interpreter = interpreter
        self._asking = asking
        self._executor = executor
        self._skills = skills
        self._states = states

    def handle(self, item: inbox.Item, turn: Turn, put_s: float) -> None:
        """Do it to the end, whatever happens. `put_s` is when it was put into the inbox."""
        try:
            self._do(item, turn, put_s)
        except Exception:
            log.exception("turn_failed")
            if inbox.can_be_stopped(item):
                turn.say(self._interpreter.phrases.say("broken"), Outcome.FAILED)

    def _do(self, item: inbox.Item, turn: Turn, put_s: float) -> None:
        match item:
            case TextInput():
                self._converse(Transcribed(clean(item.text), turn.number), turn, put_s)
            case Heard(text=said, confidence=sure):
                words = Transcribed(clean(said), turn.number, sure)
                self._converse(words, turn, item.ended_s)
            case Speak(text=text):
                turn.say(clean(text))
            case inbox.TooLong(length=length):
                if item.asked:
                    self._bus.publish(Transcribed(item.beginning, turn.number))
                book = self._interpreter.phrases
                told = book.say("too_long", length=length, limit=MAX_CHARACTERS)
                turn.say(told, Outcome.REFUSED)
            case RunSkill(name=name, arguments=arguments):
                self._executor.perform([Call(name, arguments)], self._skills, turn, "command")
            case inbox.Announce(text=text, detail=detail):
                turn.say(text, detail=detail)
            case inbox.Forget():
                self._interpreter.forget()
                self._asking.forget()
            case inbox.SwitchLanguage(code=code):
                self._interpreter.set_language(code)
                self._asking.set_language()
            case inbox.Settle():
                pass  # it needs no more than its turn
            case _:
                assert_never(item)

    def _converse(self, words: Transcribed, turn: Turn, said_s: float) -> None:
        text = words.text
        self._bus.publish(words)
        if not text:
            turn.say(self._interpreter.phrases.say("not_heard"), Outcome.NOT_UNDERSTOOD)
        else:
            self._states.enter(State.THINKING, turn)
            meaning = self._asking.attend(text, turn, said_s)
            turn.settle()
            self._interpreter.remember(text, turn, meaning)
