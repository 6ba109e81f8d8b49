"""A page's requests as commands of the robot. On a worker thread: they may wait."""

from edgevox.console import page_messages
from edgevox.console.context import ConsoleContext, ConsoleRecorder
from edgevox.console.page_messages import Message
from edgevox.console.sessions import Session
from edgevox.core.commands import Command, RunSkill, TextInput
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.ways import Way

log = get_logger(__name__)


class NotHere(EdgeVoxError):
    """The robot has no such thing."""


def command_of(context: ConsoleContext, session: Session, message: Message) -> Command | None:
    """The command that a message is; None where it is something else.

    Raises `NotHere` for what this robot cannot do.
    """
    way = session.role.way
    match message:
        case page_messages.Text(text=text):
            return TextInput(text, way)
        case page_messages.CallSkill(name=name, arguments=arguments):
            return RunSkill(name, arguments, way)
        case page_messages.GoTo(x=x, y=y):
            if not context.go_to:
                raise NotHere("goto: this robot goes nowhere")
            return context.go_to(x, y)
        case page_messages.NamePlace(name=name, x=x, y=y):
            if not context.name_place:
                raise NotHere("name_place: this robot keeps no places")
            return context.name_place(name, x, y)
    return None


def act(context: ConsoleContext, session: Session, message: Message, mark: int) -> None:
    """Do it. `mark` is the interlock's when it was asked for.

    Raises `EdgeVoxError` for what cannot be done.
    """
    if command := command_of(context, session, message):
        context.submit(command, mark)
        return
    match message:
        case page_messages.YesOrNo(yes=yes):
            _answer(context, yes, session.role.way, mark)
        case page_messages.SetControl(name=name, value=value):
            context.controls.change({name: value})
        case page_messages.Record() | page_messages.DeleteRecording():
            _record(context, session, message)


def _answer(context: ConsoleContext, yes: bool, way: Way, mark: int) -> None:
    if not context.answer:
        raise NotHere("answer: this robot asks nothing")
    context.answer(yes, way, mark)


def _record(
    context: ConsoleContext,
    session: Session,
    message: page_messages.Record | page_messages.DeleteRecording,
) -> None:
    """Start, stop or delete a recording.

    It holds what people say, so the log tells who did that.
    """
    recorder = _recorder(context)
    action, name = "delete", ""
    match message:
        case page_messages.Record(action="start" as action):
            recorder.start()
        case page_messages.Record(action=action):
            recorder.stop()
        case page_messages.DeleteRecording(name=name):
            recorder.delete(name)
    log.info("console_recording_asked", session=session.id, action=action, name=name)


def _recorder(context: ConsoleContext) -> ConsoleRecorder:
    if not context.recorder:
        raise NotHere("record: this robot records nothing")
    return context.recorder
