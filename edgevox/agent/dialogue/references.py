"""References: "again", "go back", "go there", "further", "carry on", "the other one" become calls.

The calls follow from the last actions. A reference to something that was stopped, is too long ago
or could mean two things is not carried out; the person is told what to say instead. Only "carry on"
means what was stopped. It is always asked about, and so is "go there": it means the place that was
named last, in a question, an order or an offer.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from edgevox.agent.dialogue.memory import Dialogue, DialogueExchange
from edgevox.agent.nlu.hearing.wordings import bare_name
from edgevox.agent.nlu.meaning import After, Do, Program, When, kernel, parts_of
from edgevox.agent.skills import Call, OneOf, Skill, SkillFailed
from edgevox.agent.skills.skill import TO_PLACE, TO_POINT, no_further, no_way_back, opposite_of
from edgevox.agent.text.reasons import because

_CENTIMETRES = 2


class References:
    """Finds calls in a dialogue. Each method raises `SkillFailed` with the missing piece."""

    def __init__(self, dialogue: Dialogue, skills: Mapping[str, Skill]) -> None:
        self._dialogue = dialogue
        self._skills = skills

    def again(self) -> Sequence[Call]:
        """The calls that words last asked for."""
        asked = self._repeatable(self._dialogue.asked())
        if asked.program:  # its time and number must be said again
            raise SkillFailed(because("nothing_before"))
        return tuple(asked.calls)

    def last_motion(self) -> Program:
        """The last motion that words asked for, done once: "three times" repeats it."""
        asked = self._repeatable(self._dialogue.asked(self._moved))
        if asked.program is None:
            return Do(tuple(asked.calls))
        if any(isinstance(one, After | When) for one in parts_of(asked.program)):
            raise SkillFailed(because("nothing_before"))
        return kernel(asked.program)

    def _moved(self, asked: DialogueExchange) -> bool:
        known = [call for call in asked.calls if call.skill in self._skills]
        return bool(asked.program) or any(self._skills[call.skill].drives for call in known)

    def _repeatable(self, asked: DialogueExchange | None) -> DialogueExchange:
        if asked is None or not self._dialogue.repeatable(asked):
            raise SkillFailed(because("nothing_before"))
        running = self._dialogue.running()
        if running and running.turn == asked.turn:
            raise SkillFailed(because("still_doing"))
        if asked.stopped:
            raise SkillFailed(because("was_stopped"))
        return asked

    def further(self) -> Sequence[Call]:
        """The last motion once more, if it goes by an amount and not to a place."""
        calls = [call for call in self.again() if self._skills[call.skill].drives]
        if not calls or not self._skills[calls[-1].skill].relative:
            raise SkillFailed(no_further(self._skills.values()))
        return calls[-1:]

    def resume(self) -> Sequence[Call]:
        """The last motion, if it was stopped; else that motion once more, as `further`."""
        asked = self._dialogue.asked(self._moved)
        if asked is None or not asked.stopped or not self._dialogue.repeatable(asked):
            return self.further()
        if asked.program:
            raise SkillFailed(because("was_stopped"))
        return tuple(asked.calls)

    def back(self) -> Sequence[Call]:
        """A drive to the pose where the last motion began, unless the body is there."""
        if TO_POINT not in self._skills:
            raise SkillFailed(no_way_back(self._skills.values()))
        start = self._dialogue.came_from()
        if start is None:
            raise SkillFailed(because("no_way_back"))
        x, y = round(start.x_m, _CENTIMETRES), round(start.y_m, _CENTIMETRES)
        return (Call(TO_POINT, {"x": x, "y": y}),)

    def there(self, before: Sequence[Call] = ()) -> Sequence[Call]:
        """A drive to the place that was named last, in the calls `before` or earlier.

        In a question, an order or an offer of the robot, whether it was done or not.
        """
        drive = self._skills.get(TO_PLACE)
        if drive is None and TO_POINT not in self._skills:
            raise SkillFailed(no_way_back(self._skills.values()))
        place = bare_name(drive) if drive else None
        places = drive.choices[place].words if drive and place else ()
        for call in (*reversed(before), *self._dialogue.named()):
            for value in call.arguments.values():
                if place and value in places:
                    return (Call(TO_PLACE, {place: value}),)
        raise SkillFailed(because("nothing_before"))

    def may_reverse(self) -> bool:
        """True if "go back" may ask for the reverse of the last motion: it went by an amount."""
        moved = self._dialogue.moved()
        return moved is not None and self._skills[moved.skill].relative

    def other(self) -> Sequence[Call]:
        """The last motion the other way, or with the other word of a choice between just two words.

        It may be running still: "no, the other one".
        """
        asked = self._dialogue.asked(self._moved)
        if asked is None or asked.program or not self._dialogue.repeatable(asked):
            raise SkillFailed(because("nothing_before"))
        calls = tuple(asked.calls)
        if len(calls) == 1 and (opposite := opposite_of(calls[0], self._skills)):
            return (opposite,)
        chosen = {old for call in calls for _, old, _ in self._chosen(call)}
        if not chosen:
            raise SkillFailed(because("nothing_before"))
        others = tuple(
            dict.fromkeys(
                word
                for call in calls
                for name, old, choices in self._chosen(call)
                for word in choices.words
                if word not in chosen and self._alike(call.skill, old, word)
            )
        )
        if len(others) != 1 or len(chosen) != 1:
            raise SkillFailed(because("which_one", choices=others or tuple(sorted(chosen))))
        return _exchanged(calls, chosen.pop(), others[0])

    def other_is_unsure(self) -> bool:
        """True if "the other" asks first: the last motion was stopped, or went by an amount."""
        asked = self._dialogue.asked(self._moved)
        return asked is not None and (
            asked.stopped or any(opposite_of(one, self._skills) for one in asked.calls)
        )

    def also(self, value: str) -> Sequence[Call]:
        """The last calls with this word, if it can replace only one word."""
        calls = self.again()
        for part in (calls, calls[-1:]):
            fits = {
                old
                for call in part
                for _, old, choices in self._chosen(call)
                if value in choices.words and self._alike(call.skill, old, value)
            }
            if len(fits) == 1:
                return _exchanged(part, fits.pop(), value)
        raise SkillFailed(because("does_not_go", value=value.replace("_", " ")))

    def _chosen(self, call: Call) -> Iterator[tuple[str, str, OneOf]]:
        """The arguments of this call that hold one of some words: name, word and choices."""
        for name, choices in self._skills[call.skill].choices.items():
            if call.arguments.get(name) in choices.words:
                yield name, call.arguments[name], choices

    def _alike(self, skill: str, one: str, other: str) -> bool:
        """True if two words fit the same arguments: a cube for a cube, a bin for a bin."""
        choices = self._skills[skill].choices.values()
        return all((one in known.words) == (other in known.words) for known in choices)


def _exchanged(calls: Sequence[Call], old: str, new: str) -> Sequence[Call]:
    def put(value: Any) -> Any:
        return new if value == old else value

    return tuple(
        Call(call.skill, {name: put(value) for name, value in call.arguments.items()})
        for call in calls
    )
