"""Sentences taken apart: orders one after another, and remarks beside them.

"Back up a metre, you're blocking the door" is an order and a remark; "turn left 60 degrees, drive
2 metres" two orders that no word joins.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

from edgevox.agent.nlu.decider import (
    LIKELY_DENIED,
    LIKELY_TALK,
    NOT_NOW,
    PERHAPS_NOT_NOW,
    PLAINLY_DENIED,
    PLAINLY_TALK,
    TALK,
    Decider,
)
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.lexicon import words_of
from edgevox.agent.nlu.meaning import BACK, IT, RESUME, THE_OTHER
from edgevox.agent.nlu.splitting import clauses_of, unjoined
from edgevox.agent.skills import Call
from edgevox.agent.stop.words import find_stop_word

GUESSES: Mapping[str, tuple[str, ...]] = {
    "place": ("navigate_to",),
    "point": ("navigate_xy",),
    "forward": ("drive_forward", "walk_forward"),
    "backward": ("drive_backward", "walk_backward"),
    "left": ("turn_left",),
    "right": ("turn_right",),
    "around": ("turn_around",),
    "towards": ("turn_towards",),
    "forget": ("forget_place",),
    "stand": ("stand",),
    "grasp": ("grasp",),
    "put": ("place",),
    "release": ("release",),
    "home": ("goto_home",),
    "hand": ("move_to",),
}
"""The skills that do what the encoder says is asked for, by its kinds."""

_ELSE: Mapping[str, tuple[str, ...]] = {"around": ("turn_left",), "release": ("place",)}
"""The skills that do it where the words have a value: "turn 180 degrees", "let go of the cube"."""

REFERRED: Mapping[str, str] = {
    "again": "again",
    "further": "further",
    "other_way": THE_OTHER,
    "resume": RESUME,
    "return": BACK,
    "the_other": THE_OTHER,
}
"""The references to a motion before that the encoder tells, by its kinds."""

_GUESSED = frozenset(name for names in GUESSES.values() for name in names)

OTHER, FORGET = "other", "forget"
"""Kind of an order that is none of these, and of the one that is no motion."""

LIKELY_ASKED, LIKELY_ALONE = 0.6, 0.8
"""Least likelihood of what a clause asks for, and of that without an amount or a place."""

LIKELY_REFERRED = 0.6
"""Least likelihood of words that refer to a motion before."""

PLAINLY_ASKED, SURELY_ASKED = 0.9, 0.95
"""Least likelihoods from which the encoder counts without known words, and from which it makes a
reading sure.
"""

PLAINLY_NOW = 0.9
"""Least likelihood of an order for now from which one in free words is done at once."""

LIKELY_MORE = 0.7
"""Least likelihood of an order beside those that were read."""

_MEANT_OTHERWISE = re.compile(r"[:\uff1a](?!\d)|[\"\u201c\u201d\u201e\u00ab\u00bb\u300c\u300d]")
"""Colons and quotation marks: words beside them may say how the rest is meant."""
MOST_CLAUSES = 6
"""Number of clauses that a text is taken apart into."""


@dataclass(frozen=True, slots=True)
class Clause:
    """The calls of one clause."""

    calls: tuple[Call, ...]
    """The calls, in their order."""
    sure: bool
    """True if templates read them."""
    guessed: bool = False
    """True if the words hardly say them."""
    refused: bool = False
    """True for words of a command that cannot be done as they are, and have no calls."""


def asks_for_motion(text: str, decider: Decider) -> bool:
    """True if a text most likely asks for a motion."""
    kind, likely = decider.asked(text)
    return kind in GUESSES and kind != FORGET and likely >= LIKELY_ASKED


class Rest(Enum):
    """What stands beside some calls in a text."""

    NOTHING = "nothing"
    """Remarks at most."""
    UNCLEAR = "unclear"
    """A clause that may change what is wanted: a name, a condition, a change of mind."""
    ORDER = "order"
    """Another order."""


class ClauseReader:
    """Reads texts clause by clause, for one set of skills.

    Args:
        plain: Returns a plain command that moves the robot; None for no command, and one without
            calls for any other.
        cannot: Returns what the robot must answer to an act that no skill does; empty for none.
    """

    def __init__(
        self,
        decider: Decider,
        readings: Readings,
        plain: Callable[[str], Clause | None],
        cannot: Callable[[str], str],
    ) -> None:
        self._decider = decider
        self._readings = readings
        self._plain = plain
        self._cannot = cannot
        book = readings.lexicon.book
        self._code, self._joints = book.code, book.hearing.joints
        self._results = words_of(book.code).results
        self._joining = (*self._results, *self._joints)

    def apart(self, text: str) -> Clause | None:
        """The calls of a text's clauses, one after another; None if one is no order or remark.

        Of several none may be a guess. They are sure if templates read all of them, no remark is
        left out, and none may replace the one before: "forward, back one metre" and "two metres,
        three metres". Else all of them may mean one call: "come along, we are in the kitchen".
        """
        parted = [self._clauses(text, more) for more in ((), self._results, self._joining)]
        found = next(filter(None, map(self._in_order, parted)), None)
        return found or self._as_one(text, parted[-1])

    def rest(self, text: str, calls: Sequence[Call], *, corrected: bool) -> Rest:
        """What a text holds beside these calls.

        A `corrected` text may hold words that it takes back: "not left", but not "take the blue
        cube".
        """
        for clauses in (self._clauses(text, more) for more in ((), self._joining)):
            if len(clauses) > MOST_CLAUSES:
                return Rest.UNCLEAR
            asked = (one for one in clauses if self._orders_more(one, calls))
            named = self._readings.named_in
            if len(clauses) > 1 and any(not corrected or named(one) for one in asked):
                return Rest.ORDER
        clauses = clauses_of(text, self._code)
        if self._asks_another(text, calls, LIKELY_TALK if len(clauses) == 1 else LIKELY_MORE):
            return Rest.UNCLEAR
        if corrected or len(clauses) == 1:
            return Rest.NOTHING
        skills = {one.skill for one in calls}
        parts = [self._is_part(one, skills) for one in clauses]
        for at, clause in enumerate(clauses):
            first = not any(parts[:at])
            ends = not first and find_stop_word(self._code, clause)
            remark = parts[at] or self._is_remark(clause, opens=first)
            if ends or not remark or (at and first and self._waits(clause)):
                return Rest.UNCLEAR
        return Rest.NOTHING

    def without_left(self, text: str, calls: tuple[Call, ...]) -> tuple[Call, ...]:
        """The calls without drives to what a clause wants left: "get out of the kitchen"."""
        if not _go_somewhere(calls):
            return calls
        if len(calls) == 1 and self._decider.leaves(text):
            return ()
        parted = clauses_of(text, self._code, self._joining)
        named = ((one, self._readings.named_in(one)) for one in parted)
        left = {
            place
            for one, places in named
            if places and self._decider.leaves(one)
            for place in places
        }
        return tuple(one for one in calls if left.isdisjoint(map(str, one.arguments.values())))

    def without_remarks(self, text: str) -> str:
        """A text without the plain remarks before and behind the rest; empty if it has none."""
        clauses = clauses_of(text, self._code)
        if not 1 < len(clauses) <= MOST_CLAUSES:
            return ""
        kept = [at for at, one in enumerate(clauses) if not self._is_plain_remark(one)]
        if not kept or (kept[0] == 0 and kept[-1] == len(clauses) - 1):
            return ""
        behind = clauses[kept[-1] + 1 :]
        if not all(self._is_plain_remark(one, opens=False) for one in behind):
            return ""
        first, last = clauses[kept[0]], clauses[kept[-1]]
        return text[text.index(first) : text.rindex(last) + len(last)]

    def is_plain(self, text: str, calls: Sequence[Call]) -> bool:
        """True if a text plainly orders these calls now, beside remarks at most.

        Templates or a sure reading say the same of each order's clause; of a text that is one
        clause, a reading without a doubt and the encoder. What asks, reports, names another person,
        quotes, or asks for what no skill does is not plain, nor is what stands behind a colon:
        "I'm talking to the dog: turn around".
        """
        against = (
            _MEANT_OTHERWISE.search(text)
            or _may_replace(calls)
            or self._decider.for_now(text) < PLAINLY_NOW
            or self._readings.objects(text)
            or self._cannot(text)
            or self._readings.unknown_place(text)
        )
        parted = clauses_of(text, self._code, self._joining)
        if against or len(parted) > MOST_CLAUSES:
            return False
        return self._agrees(text, calls) if len(parted) == 1 else self._are_plain(parted, calls)

    def _agrees(self, text: str, calls: Sequence[Call]) -> bool:
        """True if the encoder surely takes a text for the one motion by an amount that it reads."""
        kind, likely = self._decider.asked(text)
        if likely < SURELY_ASKED or len(calls) != 1 or not calls[0].arguments:
            return False
        amounts = all(isinstance(one, float) for one in calls[0].arguments.values())
        decision = self._decider.decide(self._readings.of(text), text)
        read = decision is not None and not decision.doubtful and decision.calls == tuple(calls)
        return amounts and read and self._whole(text, kind) == calls[0]

    def _are_plain(self, clauses: Sequence[str], calls: Sequence[Call]) -> bool:
        left = list(calls)
        for at, joined in enumerate(clauses):
            first = len(left) == len(calls)
            if at and first and self._waits(joined):
                return False
            one = unjoined(joined, self._joints, self._code)
            if left and self._plainly_orders(one, left[0]):
                left.pop(0)
            elif self._decider.for_others(one) or not self._is_plain_remark(one, opens=first):
                return False
        return not left

    def _waits(self, clause: str) -> bool:
        """True if an order may wait for what the remark before it tells: "..., then go"."""
        joined = unjoined(clause, self._joints, self._code)
        return joined != unjoined(clause, (), self._code)

    def _plainly_orders(self, clause: str, call: Call) -> bool:
        kind, likely = self._decider.asked(clause)
        if call.skill not in GUESSES.get(kind, ()) or likely < PLAINLY_ASKED:
            return False
        if self._decider.for_now(clause) < PLAINLY_NOW:
            return False
        if plain := self._plain(clause):
            return plain.sure and plain.calls == (call,)
        decision = self._decider.decide(self._readings.of(clause), clause)
        return decision is not None and decision.sure and decision.calls == (call,)

    def _is_plain_remark(self, clause: str, *, opens: bool = True) -> bool:
        """True for plain talk that denies, names, counts, conditions and reports nothing."""
        kind, likely = self._decider.asked(clause)
        plainly = (kind == TALK and likely >= PLAINLY_ASKED) or self._is_filler(clause)
        return (
            plainly
            and not self._readings.is_bound(clause)
            and not self._decider.puts_off(clause)
            and self._decider.denied(clause) < LIKELY_DENIED
            and not self._cannot(clause)
            and self._readings.is_aside(clause, may_deny=False, opens=opens)
        )

    def _clauses(self, text: str, more: tuple[str, ...]) -> Sequence[str]:
        parted = clauses_of(text, self._code, more)
        return [unjoined(one, self._joints, self._code) for one in parted]

    def _in_order(self, clauses: Sequence[str]) -> Clause | None:
        if not 0 < len(clauses) <= MOST_CLAUSES:
            return None
        found: list[Clause] = []
        before = ""
        for one in clauses:
            if before and (more := self._with_amount(before, one, found[-1])):
                found[-1] = more
            elif clause := self._read(one):
                found.append(clause)
                before = one
            elif not (self._is_remark(one, opens=not found, least=0.0) or self._denies(one, found)):
                return None
        calls = tuple(call for one in found for call in one.calls)
        if not calls or (len(found) > 1 and any(one.guessed for one in found)):
            return None
        whole = len(found) == len(clauses) and all(one.sure for one in found)
        return Clause(calls, sure=whole and not _may_replace(calls))

    def _denies(self, clause: str, found: Sequence[Clause]) -> bool:
        """True if a clause only denies another motion than those found: "forward, not back"."""
        denied = self._readings.denied(clause) if found else None
        skills = {call.skill for one in found for call in one.calls}
        return denied is not None and denied.skill not in skills

    def _read(self, clause: str) -> Clause | None:
        """A clause's calls: by templates, a sure reading, what is likely asked, or a reading."""
        plain = self._plain(clause)
        if plain is not None and not plain.refused:
            return plain if plain.calls else None
        if self._cannot(clause) or self._readings.unknown_place(clause):
            return None
        read = self._read_or_guessed(clause)
        left = read and _go_somewhere(read.calls) and self._decider.leaves(clause)
        return None if left else read

    def _read_or_guessed(self, clause: str) -> Clause | None:
        decision = self._decider.decide(self._readings.of(clause), clause)
        if decision and decision.sure:
            return Clause(decision.calls, sure=False)
        kind, likely = self._decider.asked(clause)
        if kind != FORGET and self._decider.for_now(clause) < NOT_NOW:
            return None
        small = likely < LIKELY_ALONE and self._readings.is_filler(clause)
        small = small or self._readings.is_amount(clause)
        asked = likely >= LIKELY_ASKED and not small
        call = self._whole(clause, kind, plainly=likely >= PLAINLY_ASKED) if asked else None
        if call and (call.arguments or likely >= LIKELY_ALONE):
            return Clause((call,), sure=False, guessed=likely < LIKELY_ALONE)
        return Clause(decision.calls, sure=False, guessed=True) if decision else None

    def _as_one(self, text: str, clauses: Sequence[str]) -> Clause | None:
        """The one call with a value that a text plainly asks for, if no clause asks for more."""
        kind, likely = self._decider.asked(text)
        if likely < LIKELY_ALONE or len(clauses) > MOST_CLAUSES:
            return None
        if kind != FORGET and self._decider.for_now(text) < PERHAPS_NOT_NOW:
            return None
        for clause in clauses:
            other, sure = self._decider.asked(clause)
            more = other not in (kind, TALK) and sure >= LIKELY_TALK
            said = self._plain(clause)
            skills = [one.skill for one in said.calls] if said else []
            more = more or any(one not in GUESSES.get(kind, ()) for one in skills)
            more = more or bool(self._readings.unknown_place(clause))
            if more or self._cannot(clause) or self._decider.leaves(clause):
                return None
        call = self._whole(text, kind)
        return Clause((call,), sure=False, guessed=True) if call and call.arguments else None

    def _whole(self, text: str, kind: str, *, plainly: bool = False) -> Call | None:
        """The text as one call of what the encoder says is asked for."""
        read = self._readings.whole
        call = read(text, GUESSES.get(kind, ()), plainly=plainly)
        if call is None and (found := read(text, _ELSE.get(kind, ()))) and found.arguments:
            return found
        return call

    def _with_amount(self, before: str, clause: str, read: Clause) -> Clause | None:
        """A clause whose calls say no amount, with the one that this clause is; else None.

        "Back up, I'd say, 30 centimetres".
        """
        bare = not any(call.arguments for call in read.calls)
        if not bare or not self._readings.is_amount(clause):
            return None
        whole = f"{before} {clause}"
        plain = self._plain(whole)
        if plain is not None:
            return plain if plain.calls else None
        parts = self._clauses(before, self._joining)
        found = self._read_or_guessed(whole) if len(parts) == 1 else None
        if found is None or not any(one.arguments for one in found.calls):
            return None
        same = [one.skill for one in found.calls] == [one.skill for one in read.calls]
        return found if same else None

    def _is_remark(self, clause: str, *, opens: bool, least: float = LIKELY_TALK) -> bool:
        """True if it asks for nothing and changes nothing of what is asked beside it.

        It `opens` the text if nothing was asked before it. `least` is the least likelihood of talk.
        """
        if self._readings.is_bound(clause) or self._decider.puts_off(clause):
            return False
        kind, likely = self._decider.asked(clause)
        talks = kind == TALK and likely >= least
        plainly = talks and not least and likely >= PLAINLY_TALK
        plainly = plainly and self._decider.denied(clause) < PLAINLY_DENIED
        small = self._readings.is_reason(clause) or self._readings.is_urge(clause)
        if kind in GUESSES and likely >= LIKELY_MORE and not small:
            return False
        return (
            (talks or small or self._is_filler(clause))
            and not self._cannot(clause)
            and self._readings.is_aside(
                clause,
                may_deny=talks and likely >= LIKELY_TALK,
                opens=opens,
                plainly=plainly,
            )
        )

    def _orders_more(self, clause: str, calls: Sequence[Call]) -> bool:
        """True if a clause without a value of these calls most likely orders another motion."""
        skills = {one.skill for one in calls}
        values = {str(value) for one in calls for value in one.arguments.values()} - {IT}
        if (
            skills - _GUESSED
            or self._readings.has_number(clause)
            or not values.isdisjoint(self._readings.named_in(clause))
            or self._readings.is_reason(clause)
            or self._readings.is_urge(clause)
        ):
            return False
        kind, likely = self._decider.asked(clause)
        names = {*GUESSES.get(kind, ())} & self._readings.skills
        small = self._readings.is_filler(clause) and not self._is_filler(clause)
        return bool(names) and (likely >= LIKELY_MORE or small) and skills.isdisjoint(names)

    def _asks_another(self, text: str, calls: Sequence[Call], least: float) -> bool:
        """True if a text rather asks for another motion: "drive back forward a metre"."""
        kind, likely = self._decider.asked(text)
        names = {*GUESSES.get(kind, ())} & self._readings.skills
        another = names and likely >= least and names.isdisjoint(o.skill for o in calls)
        return bool(another) and len(calls) == 1 and calls[0].skill in _GUESSED

    def _is_part(self, clause: str, skills: Collection[str]) -> bool:
        """True if a clause says something of the calls of these skills, in known words.

        "3 metres is too much" does not.
        """
        kind, likely = self._decider.asked(clause)
        if kind == TALK and likely >= LIKELY_TALK and self._readings.has_number(clause):
            return False
        return self._is_filler(clause) or self._readings.is_known(clause, skills)

    def _is_filler(self, clause: str) -> bool:
        """True if each word may be left out, and several ask for no motion: "back up a bit"."""
        kind, likely = self._decider.asked(clause)
        moves = likely >= LIKELY_TALK and (kind in GUESSES or kind in REFERRED)
        moves = moves or self._readings.says_little(clause)
        return self._readings.is_filler(clause) and not (moves and len(clause.split()) > 1)


def _may_replace(calls: Sequence[Call]) -> bool:
    """True if an order may take back the one before: that says no value, or is the same motion."""
    again = any(one.skill == other.skill for one, other in pairwise(calls))
    return again or not all(one.arguments for one in calls[:-1])


def _go_somewhere(calls: Sequence[Call]) -> bool:
    """True if a call drives to a place."""
    return any(one.skill in GUESSES["place"] for one in calls)
