"""Dialogues as data: what a person says, and what the robot then does, asks or answers.

Each dialogue of the `*.yaml` files here is a test; `README.md` says how to write one.
"""

from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
from dialogue import Dialogue, Line, calls, dialogues, files, listed
from guards import HUNG_S
from support.bodies import BODIES, FACTS
from support.body import FakeBody
from support.conversation import Talk
from support.noted_phrases import Noted, noted_phrases

from edgevox.agent.skills import Call
from edgevox.core.agent_events import Confirmation, SafetyPreempted, ToolCalled
from edgevox.core.commands import Heard, Hypothesis, Interrupt, Reset, RunSkill, TextInput
from edgevox.core.events import Cause, Responded, TurnEnded

FILES = files(Path(__file__).parent)
ALL = [
    pytest.param(one, id=f"{file.stem} {one.title}".replace(" :", ":"))
    for file in FILES
    for one in dialogues(file.read_text("utf-8"))
]
SKILLS = ("navigate_to", "navigate_xy", "walk_forward", "grasp", "place", "dance", "get_pose")


def opened(header: Mapping[str, Any]) -> Talk:
    """A conversation with the robot that the header describes."""
    more = {"skills": (*SKILLS, "stop"), **header}
    places = more.pop("rooms", ("kitchen", "office")), more.pop("aliases", {})
    body = FakeBody(arrives=True, reports=True, rooms=places[0], aliases=places[1])
    if robot := more.pop("robot", ""):
        more["skills"] = body.playing(BODIES[robot].values())
        more["facts"] = FACTS[robot]
    return Talk(body, **more)


class Reader:
    """Reads a dialogue to a robot line by line, and compares what comes of each."""

    def __init__(self, talk: Talk, noted: Noted) -> None:
        self.talk, self.noted = talk, noted

    def read(self, line: Line) -> None:
        before = self.talk.count
        self.talk.body.quick = "begins" not in line
        self.happens(line)
        self.compare(line, before)

    def happens(self, line: Line) -> None:
        talk, body, conversation = self.talk, self.talk.body, self.talk.conversation
        match line:
            case {"say": text}:
                self.send(TextInput(text))
            case {"hear": text}:
                others = tuple(Hypothesis(*one) for one in line.get("others", ()))
                sure = line.get("confidence", 1.0)
                self.send(Heard(text, talk.clock.now(), confidence=sure, others=others))
            case {"run": call}:
                (asked,) = calls(call)
                self.send(RunSkill(asked.skill, asked.arguments))
            case {"goal": call}:
                (asked,) = calls(call)
                assert conversation.start_goal(asked.skill, asked.arguments).wait(HUNG_S)
                talk.settle()
            case {"means": call}:
                talk.mean(*calls(call), source="reading", confidence=line["confidence"])
            case {"wait_s": seconds}:
                talk.clock.now_s += seconds
            case {"arrive": _}:
                assert body.moving, "nothing is on its way"
                body.arrive(1)
                talk.settle()
            case {"reset": _}:
                conversation.submit(Reset())
                talk.settle()
            case {"interrupt": cause}:
                conversation.submit(Interrupt(motion=cause != Cause.BARGE_IN, cause=Cause(cause)))
                talk.settle()
            case {"confirm": when}:
                conversation.set_confirm(when)
            case {"speak": language}:
                conversation.set_language(language)
                talk.settle()
            case {"learn": name}:
                body.learned = (*body.learned, name)
            case {"lose": _}:
                body.lost = True

    def send(self, command: Any) -> None:
        """Until everything has ended; where a drive goes on beside it, until it is answered."""
        talk, before = self.talk, self.talk.count
        goes_on = talk.body.moving
        talk.conversation.submit(command)
        talk.until(lambda: talk.of(TurnEnded, since=before))
        moves = any(map(self.moves, self.called(before)))
        if moves and not talk.body.quick:
            talk.until(lambda: talk.body.moving)
        elif moves or not goes_on:
            talk.settle()

    def called(self, before: int) -> list[Any]:
        return self.talk.of(ToolCalled, SafetyPreempted, since=before)

    def moves(self, event: Any) -> bool:
        skill = self.talk.skills.get(event.skill) if isinstance(event, ToolCalled) else None
        return isinstance(event, SafetyPreempted) or (skill is not None and skill.moves)

    def compare(self, line: Line, before: int) -> None:
        """What is not written in the line must not have happened."""
        asked = self.talk.of(Confirmation, since=before)
        questions = [call for one in asked if one.status == "asked" for call in one.calls]
        became = [str(one.status) for one in asked if one.status != "asked"]

        assert self.told(before) == self.whole(line.get("does") or line.get("begins"))
        assert [(one.skill, dict(one.arguments)) for one in questions] == self.whole(
            line.get("asks")
        )
        assert became == listed(line.get("answered", became))
        self.compare_words(line, self.talk.of(Responded, since=before))

    def compare_words(self, line: Line, answers: list[Responded]) -> None:
        said = " ".join(one.text for one in answers)
        written = " ".join(one.detail for one in answers)
        wanted = set(listed(line.get("says", [])))
        wanted |= {"refused", line["refuses"]} if "refuses" in line else set()
        wanted |= {"failed", line["fails"]} if "fails" in line else set()
        keys = self.noted.keys_in(said, self.talk.conversation.interpreter.phrases.code)

        assert wanted <= keys, f"{said!r} is {sorted(keys)}"
        for name, text in (("mentions", said), ("writes", written)):
            assert [one for one in listed(line.get(name, [])) if str(one) not in text] == [], text
        assert [one for one in listed(line.get("omits", [])) if str(one) in said] == [], said

    def told(self, before: int) -> list[tuple[str, dict[str, Any]]]:
        """What was called; a stop word is the skill that stops."""
        return [
            ("stop", {}) if isinstance(one, SafetyPreempted) else (one.skill, dict(one.arguments))
            for one in self.called(before)
        ]

    def whole(self, written: str | None) -> list[tuple[str, dict[str, Any]]]:
        """Calls with the arguments that they leave to their defaults."""
        return [(one.skill, self.arguments(one)) for one in calls(written)]

    def arguments(self, call: Call) -> dict[str, Any]:
        skill = self.talk.skills.get(call.skill)
        return dict(skill.validate(call.arguments)) if skill else dict(call.arguments)


class Talks:
    """The conversation of the last dialogue, kept for the next with the same robot."""

    def __init__(self) -> None:
        self._kept: tuple[Any, Talk] | None = None

    @contextmanager
    def talk(self, dialogue: Dialogue) -> Iterator[Talk]:
        kept, self._kept = self._kept, None
        if kept and (kept[0] != dialogue.header or not dialogue.plain):
            kept[1].__exit__()
            kept = None
        talk = kept[1] if kept else opened(dialogue.header).__enter__()
        try:
            yield talk
        except BaseException:
            talk.__exit__()
            raise
        talk.start_over(dialogue.header.get("confirm", "unsure"))
        self._kept = (dialogue.header if dialogue.plain else None, talk)

    def close(self) -> None:
        if self._kept:
            self._kept[1].__exit__()


@pytest.fixture(scope="module")
def talks() -> Iterator[Talks]:
    with closing(Talks()) as found:
        yield found


@pytest.mark.parametrize("dialogue", ALL)
def test_what_is_said_comes_to_what_is_written(dialogue: Dialogue, talks: Talks) -> None:
    with talks.talk(dialogue) as talk, noted_phrases() as noted:
        for line in dialogue.lines:
            Reader(talk, noted).read(line)


@pytest.mark.parametrize(
    "wrong",
    [
        "{say: go to the kitchen}",
        "{say: go to the kitchen, does: navigate_to(room=office)}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen) + get_pose()}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen), asks: get_pose()}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen), answered: declined}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen), says: stopped}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen), mentions: garage}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen), omits: kitchen}",
        "{say: go to the kitchen, does: navigate_to(room=kitchen), writes: kitchen}",
        "{say: go to the garage, says: missing_word}",
        "{say: go to the kitchen, dose: navigate_to(room=kitchen)}",
        "{say: go to the kitchen, hear: go to the kitchen, does: navigate_to(room=kitchen)}",
        "{say: walk 30 metres, refuses: too_small}",
        "{say: walk 30 metres, fails: too_large}",
        "{say: stop}",
        "{say: where are you, begins: navigate_to(room=kitchen)}",
        "{arrive: there}",
    ],
)
def test_a_dialogue_that_is_wrong_fails(wrong: str, talks: Talks) -> None:
    with pytest.raises((AssertionError, ValueError)):  # noqa: PT012 - read, then played
        (one,) = dialogues(f"dialogues: {{wrong: [{wrong}]}}")
        test_what_is_said_comes_to_what_is_written(one, talks)
