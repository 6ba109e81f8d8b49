"""The console's context, built from an agent.

It holds the skills as a page makes forms of them: their schemas, with the policy's limits in them.

A page has a listener of its own, made like the room's. So the room's listener goes on hearing stop
words while pages are open, and speech in the room is not taken for speech into a held button. Both
share the speech-to-text engine.
"""

import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.policy import Guard, PolicyContext, Rule
from edgevox.agent.policy.limits import PLACES, PolicyLimits
from edgevox.agent.skills import STOP, Skill
from edgevox.agent.skills.failures import SkillFailed, WrongArgument, reason_of
from edgevox.agent.skills.skill import TO_POINT
from edgevox.agent.text.words import as_part, spoken_name
from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.agent.voice import endings, open_stop_detector, open_wakeword
from edgevox.apps.console.robot_recorder import NoRecorder, RobotRecorder
from edgevox.apps.console.shown_robot import ShownRobot
from edgevox.console.context import ConsoleContext, ConsoleSound
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Heard, RunSkill, TextInput, Way
from edgevox.core.events import SentenceReady, TurnMeasured
from edgevox.core.languages import LANGUAGES
from edgevox.core.motion.interlock import StreamStopped
from edgevox.core.reason import Reason
from edgevox.core.settings import CONFIRM
from edgevox.ops.logs import TurnLines
from edgevox.robots.places.skills import REMEMBER
from edgevox.voice.listener import Listener
from edgevox.voice.sinks.paced import Tap, TappedSink
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.vad import open_vad


def offered(
    skills: Sequence[Skill], guard: Guard, phrases: Phrasebook, way: Way
) -> list[dict[str, Any]]:
    """Each skill as this way may ask for it, told in the language of the phrasebook.

    Descriptions are English, and so are labels of skills that the phrasebook does not know.
    """
    file = guard.look().file
    is_english = phrases.code == ENGLISH
    return [
        {
            "name": one.name,
            "label": phrases.can(one),
            "language": ENGLISH
            if is_english or phrases.can(one) == as_part(one.description)
            else phrases.code,
            "description": one.description if is_english else "",
            "schema": limited(one.schema, file.limits, guard.around) if one.drives else one.schema,
            "moves": one.drives,
            "lasting": one.lasting,
            "allowed": one.name == STOP or file.rule(way, one.name) is not Rule.DENY,
        }
        for one in skills
    ]


def argument_labels(skills: Sequence[Skill], phrases: Phrasebook) -> dict[str, str]:
    """What the phrasebook calls the skills' arguments: "Distance in metres"."""
    names = {name for one in skills for name in one.schema.get("properties", {})}
    known = ((name, phrases.arguments.get(spoken_name(name), "")) for name in sorted(names))
    labels = ((name, phrases.without_article(said)) for name, said in known if said)
    return {name: f"{said[:1].upper()}{said[1:]}" for name, said in labels}


def word_labels(skills: Sequence[Skill], phrases: Phrasebook) -> dict[str, str]:
    """What the phrasebook calls places, things and other words that the skills take."""
    labels: dict[str, str] = {}
    for choices in (choices for one in skills for choices in one.choices.values()):
        for word in choices.words:
            own = choices.names.get(word, {}).get(phrases.code)
            labels[word] = phrases.without_article(own.name if own else str(phrases.word(word)))
    return {word: said for word, said in labels.items() if said != word.replace("_", " ")}


def limited(
    schema: Mapping[str, Any], limits: PolicyLimits, around: PolicyContext
) -> dict[str, Any]:
    """The schema of what is permitted. What it cannot say, the policy refuses when it is asked."""
    fields = schema.get("properties", {})
    return {
        **schema,
        "properties": {name: _field(name, one, limits, around) for name, one in fields.items()},
    }


def _field(
    name: str, field: Mapping[str, Any], limits: PolicyLimits, around: PolicyContext
) -> dict[str, Any]:
    found = dict(field)
    if limits.places and name in PLACES and "enum" in found:
        lasting = limits.model_copy(update={"distance_m": None})
        found["enum"] = [
            word for word in found["enum"] if not lasting.against({name: word}, around)
        ]
    if limits.distance_m and name == "distance":
        found["maximum"] = min(limits.distance_m, found.get("maximum", limits.distance_m))
    area = limits.goals
    if area and name in ("x", "y"):
        span = getattr(area, name)
        found |= {
            key: end
            for key, end in (("minimum", span.least), ("maximum", span.most))
            if end is not None
        }
    return found


MOST_LATENCIES = 50


def build_context(
    parts: AgentParts,
    sound: ConsoleSound | None = None,
    recorder: RobotRecorder | NoRecorder = NoRecorder.ROS2,
) -> ConsoleContext:
    """All of it, for an agent that was put together. It listens to the bus from now on."""
    return _OfAgent(parts, recorder).context(sound)


class _OfAgent:
    def __init__(self, parts: AgentParts, recorder: RobotRecorder | NoRecorder) -> None:
        self._parts = parts
        self._recorder = recorder if isinstance(recorder, RobotRecorder) else None
        self._record = str(recorder) if isinstance(recorder, NoRecorder) else True
        self._robot = (
            ShownRobot(
                parts.body,
                parts.interlock,
                parts.guard,
                self._label,
                lambda: parts.conversation.moving,
            )
            if parts.body
            else None
        )
        self._latencies: deque[Mapping[str, Any]] = deque(maxlen=MOST_LATENCIES)
        parts.bus.subscribe(TurnMeasured, lambda event: self._latencies.append(asdict(event)))

    def context(self, sound: ConsoleSound | None) -> ConsoleContext:
        parts = self._parts
        goes = any(one.name == TO_POINT for one in parts.skills)
        names = any(one.name == REMEMBER for one in parts.skills)
        return ConsoleContext(
            name=parts.name,
            bus=parts.bus,
            interlock=parts.interlock,
            submit=parts.command_router.submit,
            controls=parts.controls,
            safety=parts.software_stop,
            describe=self._describe,
            status=self._status,
            robot=self._robot,
            sound=sound,
            recorder=self._recorder,
            answer=self._answer,
            go_to=_go_to if goes else None,
            name_place=_name_place if names else None,
            follow_log=_follow_log,
            explain=self._explain,
            stops=self._stops,
        )

    def _describe(self, language: str) -> Mapping[str, Any]:
        """Return the message that a page gets once, in its own language if the robot has that."""
        controls = self._parts.controls
        phrases = self._phrases(language)
        here = self._robot.capabilities if self._robot else {}
        return {
            "languages": list(LANGUAGES),
            "controls": {
                "languages": list(LANGUAGES),
                "voices": list(controls.voices),
                "confirms": list(CONFIRM),
            },
            "words": word_labels(self._parts.skills, phrases),
            "arguments": argument_labels(self._parts.skills, phrases),
            "skills": offered(self._parts.skills, self._parts.guard, phrases, Way.CONSOLE_OPERATOR),
            "capabilities": {
                **here,
                "sound": self._parts.voice is not None,
                "record": self._record,
            },
        }

    def _explain(self, why: Reason | Exception, language: str) -> str:
        """Return the reason of a failure; empty if the phrasebooks have no sentence for it."""
        if isinstance(why, StreamStopped):
            why = why.reason
        elif isinstance(why, SkillFailed | WrongArgument):
            why = reason_of(why)
        return self._phrases(language).reason(why) if isinstance(why, Reason) else ""

    def _phrases(self, language: str) -> Phrasebook:
        return phrasebook(language if language in LANGUAGES else self._parts.controls.language)

    def _status(self) -> Mapping[str, Any]:
        """Return the status of all parts."""
        health = self._parts.health
        live, ready = health.live(), health.ready()
        problems = [f"{name}: {said}" for name, said in ready.checks.items() if said]
        return {
            "health": {"live": live.well, "ready": ready.well, "problems": problems},
            "diagnostics": [
                {
                    "name": one.name,
                    "level": int(one.level),
                    "message": one.message,
                    "values": dict(one.values),
                }
                for one in self._parts.components.statuses()
            ],
            "latencies": list(self._latencies),
            **({"recording": self._recorder.state()} if self._recorder else {}),
        }

    def _answer(self, yes: bool, way: Way, mark: int | None = None) -> None:
        """Say yes or no in the language that is spoken: it counts as if it had been typed."""
        words = phrasebook(self._parts.controls.language).answers
        said = (words.yes if yes else words.no)[0]
        self._parts.command_router.submit(TextInput(said, way), mark)

    def _stops(self, command: Command) -> bool:
        """Return whether the command stops the robot, by a word or by the skill."""
        if isinstance(command, TextInput):
            return self._parts.conversation.is_stop(command.text)
        return isinstance(command, RunSkill) and command.name == STOP

    def _label(self, name: str) -> str:
        said = str(phrasebook(self._parts.controls.language).word(name))
        return said or name.replace("_", " ")


def _follow_log(tell: Callable[[Mapping[str, Any]], None]) -> Callable[[], object]:
    lines = TurnLines(tell)
    lines.open()
    return lines.close


def _name_place(name: str, x_m: float, y_m: float) -> Command:
    return RunSkill(REMEMBER, {"name": name, "x": x_m, "y": y_m}, Way.CONSOLE_OPERATOR)


def _go_to(x_m: float, y_m: float) -> Command:
    return RunSkill(TO_POINT, {"x": x_m, "y": y_m}, Way.CONSOLE_OPERATOR)


SOURCE = "console"


class SharedSound:
    """A `ConsoleSound`: one client at a time speaks into `microphone`, all may hear `sink`."""

    def __init__(self, microphone: Pushed, sink: TappedSink, bus: Bus) -> None:
        self._microphone = microphone
        self._sink = sink
        self._lock = threading.Lock()
        self._client = ""
        self._held = False
        self._turn = 0
        self._forget = bus.subscribe(SentenceReady, self._said)

    def open(self, client: str, *, held: bool) -> bool:
        """See `ConsoleSound.open`."""
        with self._lock:
            if self._client not in ("", client):
                return False
            released = self._held and not held
            self._client, self._held = client, held
            if released:
                self._microphone.end()
            return True

    def close(self, client: str) -> None:
        """See `ConsoleSound.close`."""
        if self._release(client):
            self._microphone.end()

    def abandon(self, client: str) -> None:
        """See `ConsoleSound.abandon`."""
        if self._release(client):
            self._microphone.abandon()

    def push(self, client: str, samples: NDArray[np.int16]) -> None:
        """See `ConsoleSound.push`."""
        with self._lock:
            if client == self._client:
                self._microphone.push(samples, addressed=self._held)

    def listen(
        self, callback: Callable[[int, bytes], None], on_flush: Callable[[], None]
    ) -> Callable[[], None]:
        """See `ConsoleSound.listen`."""
        hear = Tap(lambda samples: callback(self._turn, samples.astype("<i2").tobytes()), on_flush)
        return self._sink.tap(hear)

    def shut(self) -> None:
        """Follow the conversation no longer."""
        self._forget()

    def _release(self, client: str) -> bool:
        with self._lock:
            if client != self._client:
                return False
            self._client, self._held = "", False
            return True

    def _said(self, sentence: SentenceReady) -> None:
        self._turn = sentence.turn


def share_sound(stack: ExitStack, parts: AgentParts) -> SharedSound | None:
    """Hear pages from now on; what must end is the stack's. None for an agent that only writes."""
    voice, settings, controls = parts.voice, parts.settings, parts.controls
    if voice is None:
        return None
    wakeword = open_wakeword(settings)
    if wakeword:
        stack.callback(wakeword.close)
    microphone = Pushed(SOURCE)
    listener = Listener(
        microphone,
        open_vad(),
        voice.stt,
        submit=lambda command: parts.command_router.submit(_of_console(command)),
        bus=parts.bus,
        language=lambda: controls.language,
        muted=lambda: controls.muted,
        audible=voice.sink.audible,
        wakeword=wakeword,
        is_stop=parts.conversation.is_stop,
        follow_up=parts.conversation.follow_ups,
        stop_detector=open_stop_detector(settings),
        ending=endings(parts.conversation).of,
        saying=voice.speech_output.saying,
    )
    stack.callback(listener.close)
    listener.start()
    sound = SharedSound(microphone, voice.sink, parts.bus)
    stack.callback(sound.shut)
    return sound


def _of_console(command: Command) -> Command:
    """Mark a command from an operator's microphone with the console's way, for the policy."""
    return replace(command, way=Way.CONSOLE_OPERATOR) if isinstance(command, Heard) else command
