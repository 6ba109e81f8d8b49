"""The socket `/ws`: a page's requests and the robot's messages, as JSON.

Requests become commands of the robot on a worker thread: they may wait.
"""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from aiohttp import WSMsgType, web

from edgevox.console.context import ConsoleContext, ConsoleRecorder
from edgevox.console.limits import BadRequest, BadRequests, PageRateLimit
from edgevox.console.outbox import Outbox
from edgevox.console.page_hub import FLOOD, SLOW, PageHub, encode
from edgevox.console.sessions import Role, Session
from edgevox.console.sockets import messages
from edgevox.console.sockets.messages import Message
from edgevox.core.clock import Clock
from edgevox.core.commands import Command, RunSkill, TextInput, Way
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import StreamStopped

log = get_logger(__name__)


class NotHere(EdgeVoxError):
    """The robot has no such thing."""


def command_of(context: ConsoleContext, session: Session, message: Message) -> Command | None:
    """The command that a message is; None where it is something else.

    Raises `NotHere` for what this robot cannot do.
    """
    way = session.role.way
    match message:
        case messages.Text(text=text):
            return TextInput(text, way)
        case messages.CallSkill(name=name, arguments=arguments):
            return RunSkill(name, arguments, way)
        case messages.GoTo(x=x, y=y):
            if not context.go_to:
                raise NotHere("goto: this robot goes nowhere")
            return context.go_to(x, y)
        case messages.NamePlace(name=name, x=x, y=y):
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
        case messages.YesOrNo(yes=yes):
            _answer(context, yes, session.role.way, mark)
        case messages.SetControl(name=name, value=value):
            context.controls.change({name: value})
        case messages.Record() | messages.DeleteRecording():
            _record(context, session, message)


def _answer(context: ConsoleContext, yes: bool, way: Way, mark: int) -> None:
    if not context.answer:
        raise NotHere("answer: this robot asks nothing")
    context.answer(yes, way, mark)


def _record(
    context: ConsoleContext,
    session: Session,
    message: messages.Record | messages.DeleteRecording,
) -> None:
    """Start, stop or delete a recording.

    It holds what people say, so the log tells who did that.
    """
    recorder = _recorder(context)
    action, name = "delete", ""
    match message:
        case messages.Record(action="start" as action):
            recorder.start()
        case messages.Record(action=action):
            recorder.stop()
        case messages.DeleteRecording(name=name):
            recorder.delete(name)
    log.info("console_recording_asked", session=session.id, action=action, name=name)


def _recorder(context: ConsoleContext) -> ConsoleRecorder:
    if not context.recorder:
        raise NotHere("record: this robot records nothing")
    return context.recorder


PER_S, BURST = 20.0, 40
FLOOD_PER_S, FLOOD_BURST = 100.0, 400
"""A client that sends more messages than this, of any kind, is disconnected."""
MOST_WAITING = 40


class NotPermitted(Exception):
    """A request is refused; `code` tells a page why."""

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(message)


@dataclass(frozen=True)
class SocketLimits:
    """Rate limits by client; invalid messages are counted in `bad`."""

    commands: PageRateLimit
    flood: PageRateLimit
    bad: BadRequests

    @classmethod
    def usual(cls, clock: Clock, bad: BadRequests) -> "SocketLimits":
        """Make limits that suit a person with a stick."""
        return cls(
            PageRateLimit(clock, PER_S, BURST), PageRateLimit(clock, FLOOD_PER_S, FLOOD_BURST), bad
        )


class ControlPage:
    """A page on `/ws`, from `run` until it is gone.

    `mark` is the interlock's from before the page could say anything.
    """

    def __init__(
        self,
        hub: PageHub,
        session: Session,
        socket: web.WebSocketResponse,
        limits: SocketLimits,
        abort: Callable[[], None],
        *,
        mark: int,
    ) -> None:
        self.session = session
        self.looks: frozenset[str] = frozenset()
        self.language = ""
        self._hub = hub
        self._socket = socket
        self._limits = limits
        self._abort = abort
        self._closing: asyncio.Task[Any] | None = None
        self._waiting: asyncio.Queue[tuple[Message, int]] = asyncio.Queue(MOST_WAITING)
        self._mark = mark
        self._asks = False
        self._pings: set[asyncio.Task[Any]] = set()
        self.outbox = Outbox(lambda: self.hang_up(SLOW))

    def hang_up(self, code: int) -> None:
        """Close its socket, and its connection where it does not take that."""
        if self._closing is None:
            self._closing = asyncio.create_task(self._close(code))

    async def run(self, language: str) -> None:
        """Answer it until it is gone."""
        hub = self._hub
        hub.enter(self)
        if self._mark != hub.context.interlock.mark:
            self.stopped(hub.context.interlock.mark)
        tasks = [
            asyncio.create_task(self._send(language)),
            asyncio.create_task(self._work()),
        ]
        try:
            async for told in self._socket:
                if told.type is WSMsgType.PING:
                    await self._socket.pong(told.data)
                elif told.type is WSMsgType.PONG:
                    self._answered(told.data)
                elif told.type is WSMsgType.TEXT:
                    self.take(told.data)
                else:
                    break
                if self._closing:
                    break
        finally:
            hub.leave(self)
            tasks += self._pings
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            if self._closing:
                await self._closing

    def stopped(self, mark: int) -> None:
        """React to a stop, or its release: the interlock is at `mark`.

        A stop that this page asked for comes before all its later messages.
        """
        if self._asks and self._mark == mark - 1:
            self._mark = mark
            return
        ping = asyncio.create_task(self._ping(mark))
        self._pings.add(ping)
        ping.add_done_callback(self._pings.discard)

    async def _ping(self, mark: int) -> None:
        with suppress(OSError, RuntimeError):  # it is gone: it says nothing more
            await self._socket.ping(b"%d" % mark)

    def _answered(self, payload: bytes) -> None:
        """A pong: what it answers was sent with this mark, or by a heartbeat without one."""
        if payload.isdigit():
            self._mark = max(self._mark, min(int(payload), self._hub.context.interlock.mark))

    async def _send(self, language: str) -> None:
        """Greet it, then send what there is; meanwhile it may say stop."""
        try:
            hello, scene = await self._hello(language), await self._scene()
            self.outbox.put_first(hello)
            if scene:
                self.outbox.put_unless_newer("scene", scene)
            await self.outbox.send_all(self._socket)
        except (OSError, RuntimeError, TimeoutError):
            self.hang_up(SLOW)
        except Exception:
            log.exception("console_greeting_failed")
            self.hang_up(SLOW)

    def take(self, text: str) -> None:
        """Do the page's message, or put it in line. Never waits."""
        self._asks = True
        try:
            self._read(text)
        finally:
            self._asks = False

    def _read(self, text: str) -> None:
        try:
            message = messages.read(text)
        except InvalidValue as error:
            self._limits.bad.count(BadRequest.MESSAGE)
            if self._is_within(self._limits.flood):
                self._refuse(None, "invalid", str(error), error)
            return
        if isinstance(message, messages.Stop):
            self._stop(message)
            stops = True
        elif stops := self._stops(message):
            self._answer(message, lambda: self._stop_by(message))
        if not self._is_within(self._limits.flood) or stops:
            return
        self._answer(message, lambda: self._take(message))

    def _take(self, message: Message) -> bool:
        """Return whether the message is done; otherwise it waits in line."""
        releases = isinstance(message, messages.Drive) and message.releases
        if releases and self._hub.driving:
            self._hub.driving.release(self)
            return True
        asks = not isinstance(message, messages.Ping | messages.Look)
        if asks and not self._limits.commands.allows(self.session.id):
            raise NotPermitted("rate", f"at most {PER_S:g} commands a second")
        self._authorise(message)
        match message:
            case messages.Ping(t=t):
                self._say({"type": "pong", "t": t})
            case messages.Look(what=what):
                self.looks = frozenset(what)
            case messages.ChangeLease():
                self._lease(message)
            case messages.Drive(linear=linear, angular=angular):
                self._drive(linear, angular)
            case messages.Resume():  # not in line: it must not undo a stop that came after it
                self._hub.context.safety.resume(self.session.name)
            case _:
                self._wait(message)
                return False
        return True

    def _stop(self, message: messages.Stop) -> None:
        try:
            self._hub.stop(self.session.name)
        except Exception as error:
            log.exception("console_stop_failed")
            self._refuse(message.id, "failed", str(error))
        else:
            self._say({"type": "ok", "reply_to": message.id})

    def _stops(self, message: Message) -> bool:
        """Return whether it stops the robot by the word or the skill; that needs no right."""
        try:
            command = command_of(self._hub.context, self.session, message)
        except NotHere:
            return False
        return command is not None and self._hub.context.stops(command)

    def _stop_by(self, message: Message) -> bool:
        act(self._hub.context, self.session, message, self._mark)
        return True

    def _authorise(self, message: Message) -> None:
        """Raises `NotPermitted` unless this page may, now."""
        if message.needs == "session":
            return
        if not self._hub.sessions.is_there(self.session):
            self._hub.dismiss(self)
            raise NotPermitted("viewer", "this browser is no longer let in")
        if self.session.role is not Role.OPERATOR:
            raise NotPermitted("viewer", "only an operator may do this")
        if message.needs == "lease":
            if self._hub.lease.state.holder != self.session.id:
                raise NotPermitted("no_lease", "another commands, or nobody: take the turn")
            self._hub.lease.used(self.session.id)

    def _lease(self, message: messages.ChangeLease) -> None:
        lease, client = self._hub.lease, self.session.id
        done = True
        if message.action == "take":
            done = lease.take(client)
        elif message.action == "request":
            lease.request(client)
        elif message.action == "withdraw":
            lease.withdraw(client)
        else:
            done = lease.give(client, message.to)
        self._hub.tell_lease()
        if not done:
            raise NotPermitted("no_lease", "it is not yours to take or to give")

    def _drive(self, linear_m_s: float, angular_rad_s: float) -> None:
        if self._hub.driving is None:
            raise NotPermitted("invalid", "this robot is not driven")
        if not self._hub.driving.is_free_for(self):  # a browser's tabs share its turn
            raise NotPermitted("busy", "another page of this browser drives")
        try:
            self._hub.driving.steer(self, linear_m_s, angular_rad_s, self._mark)
        except StreamStopped as error:
            raise NotPermitted("let_go", "stopped: release the stick") from error
        except EdgeVoxError as error:  # it was asked all the same: a held stick has not paused
            if self._hub.context.safety.state.engaged:
                raise NotPermitted("stopped", "the software stop is engaged") from error
            raise

    def _wait(self, message: Message) -> None:
        try:
            self._waiting.put_nowait((message, self._mark))
        except asyncio.QueueFull:
            raise NotPermitted("rate", "too much waits to be done") from None

    async def _work(self) -> None:
        """Do the waiting messages in order; the right to each is checked again at its turn."""
        while True:
            message, mark = await self._waiting.get()
            try:
                if self._hub.context.interlock.outdated(mark):
                    code = "stopped" if self._hub.context.safety.state.engaged else "outdated"
                    raise NotPermitted(code, "a stop came first")
                self._authorise(message)
                await self._hub.work(act, self._hub.context, self.session, message, mark)
                self._say({"type": "ok", "reply_to": message.id})
            except (NotPermitted, EdgeVoxError, OSError) as error:
                self._tell_refusal(message.id, error)
            except Exception as error:
                log.exception("console_command_failed", kind=message.type)
                self._refuse(message.id, "failed", repr(error))

    def _answer(self, message: Message, done: Callable[[], bool]) -> None:
        try:
            if done() and not isinstance(message, messages.Ping):
                self._say({"type": "ok", "reply_to": message.id})
        except (NotPermitted, EdgeVoxError) as error:
            self._tell_refusal(message.id, error)
        except Exception as error:
            log.exception("console_command_failed", kind=message.type)
            self._refuse(message.id, "failed", repr(error))

    def _is_within(self, flood: PageRateLimit) -> bool:
        if flood.allows(self.session.id):
            return True
        self.hang_up(FLOOD)
        return False

    def _tell_refusal(self, reply_to: int, error: Exception) -> None:
        code = error.code if isinstance(error, NotPermitted) else "invalid"
        self._refuse(reply_to, code, str(error), error)

    def _refuse(
        self, reply_to: int | None, code: str, message: str, error: Exception | None = None
    ) -> None:
        told = {"type": "error", "reply_to": reply_to, "reason": code, "message": message}
        if error:
            told["why"] = self._hub.context.explain(error, self.language)
        if isinstance(error, InvalidValue):
            told |= {"field": error.field, "expected": error.expected}
        self._say(told)

    def _say(self, message: dict[str, Any]) -> None:
        if text := encode(message):
            self.outbox.put(text)

    async def _hello(self, language: str) -> str:
        hub = self._hub
        told = await hub.work(hub.context.describe, language)
        self.language = language
        hello = {
            **told,
            "type": "hello",
            "protocol": messages.PROTOCOL,
            "robot": hub.context.name,
            "role": str(self.session.role),
            "client": self.session.id,
            "lease": hub.lease_of(self.session),
            "stop": hub.stop_of(),
            "controls": {**told.get("controls", {}), **hub.controls_of()},
            "talk": hub.last_turns.messages(),
            "recording": hub.context.recorder is not None and hub.context.recorder.running,
        }
        return encode(hello) or "{}"

    async def _scene(self) -> str | None:
        robot = self._hub.context.robot
        if robot is None:
            return None
        return encode({**await self._hub.work(robot.scene), "type": "scene"})

    async def _close(self, code: int) -> None:
        try:
            async with asyncio.timeout(1):
                await self._socket.close(code=code)
        except (TimeoutError, OSError, RuntimeError):
            pass
        finally:
            self._abort()
