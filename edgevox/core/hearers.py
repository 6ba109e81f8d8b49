"""Robots that hear the same person agree which of them answers.

Each robot of a group tells the others how well it heard an utterance (`Claim`), before it knows the
words. The one that heard it best decides once it knows them: the robot that they name answers, else
the one that asked a question, else the one that heard best. The others wait for its word.

The rule that only one answers needs no clock but the robot's own. Claims tell how long ago an
utterance was. Time is counted in the robot's own messages that came back over the wire, as in
`ros2.presence`: a robot that is frozen, or whose executor is held up, counts nothing, so it neither
decides nor takes another for gone. It decides only `SETTLE_BEATS` after its claim went out: a robot
that heard the same by then is known, and its decision, if it came first, has arrived.

A robot whose claims cease is gone, and the next best decides. What a robot says itself it claims as
well, with its text, so that the others do not answer it. Another robot's claim can keep this
one silent for an utterance, and do nothing else. Stop words never come here.
"""

import secrets
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Annotated

from pydantic import ConfigDict, Field, TypeAdapter
from pydantic.dataclasses import dataclass as checked

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Heard
from edgevox.core.files.validation import read_message
from edgevox.core.spoken_names import MAY_BE, echoes, named_in, without_name

BEAT_S = 0.04
"""Seconds between two claims while an utterance is undecided."""
IDLE_BEATS = 25
"""Beats between two messages while there is none."""
SETTLE_BEATS = 5
"""Beats from a robot's claim to its decision: more than a message needs, there and back."""
HELD_UP_S = 3 * BEAT_S
"""A robot that receives none of its own messages for so long was held up. It then waits
`SETTLE_BEATS` again before it decides."""
GONE_BEATS = 6
"""Beats after which a robot whose claims have ceased decides nothing more."""
NAME_BEATS = 6
"""Beats for which the best waits for the others' words, if it may have misheard a name."""
PRESENT_BEATS = 4 * IDLE_BEATS
"""Beats after which a robot that says nothing has left the group."""
PATIENCE_BEATS = 50
"""Beats that a robot which knows the words waits for one that heard better and does not."""
LATEST_S = 5.0
"""Seconds, once its words are known, after which a robot that cannot decide leaves an utterance."""
TOLD_BEATS = 25
"""Beats for which a decision is repeated: messages are not sent again if they are lost."""
KEPT_S = 30.0
"""Seconds for which a decision is remembered, and told to a robot that claims the utterance late.
Nothing older is answered."""
ANOTHER = "another robot"
"""The name of a robot that is not known."""
SAME_WAKE_S = 0.7
"""Wake words that are further apart belong to two utterances."""
OVERLAP = 0.5
"""Share of the shorter of two utterances that the other must cover."""
LEAST_S = 0.1
MOST_SAID = 300
"""Characters of a robot's own speech that the others get: the last ones."""
MOST_ROBOTS = 32
MOST_UTTERANCES = 8
MOST_PER_S = 1000
"""Messages that are read in a second; the rest are dropped."""
MAX_CHARACTERS = 1024
MOST_MS = 30_000
"""The longest utterance, and the longest time since one."""

Id = Annotated[str, Field(pattern="^([0-9a-f]{8})?$")]
Name = Annotated[str, Field(max_length=40)]
Milliseconds = Annotated[int, Field(ge=0, le=MOST_MS)]


@checked(frozen=True, config=ConfigDict(strict=True, extra="ignore"))
class Claim:
    """What a robot says of itself, and of one utterance."""

    id: Annotated[str, Field(pattern="^[0-9a-f]{8}$")]
    """The agent's own, for as long as it runs."""
    name: Name
    """The name by which people call the robot."""
    group: Name
    beat: Annotated[int, Field(ge=0)]
    """Number of beats since its start."""
    utterance: Annotated[int, Field(ge=0, le=2**31)] = 0
    """The robot's own number of the utterance; 0 if it tells of none."""
    ago_ms: Milliseconds = 0
    """Time since the last voiced sample."""
    lasted_ms: Milliseconds = 0
    woken_ms: Milliseconds | None = None
    """Time since the wake word; None without one."""
    level_db: Annotated[float, Field(ge=-200.0, le=200.0)] = 0.0
    """Decibels by which it stands out of the noise."""
    asked: bool = False
    """Whether it may answer a question of the robot."""
    words: bool = False
    """Whether the robot knows its words."""
    waited: bool = False
    """Whether it has known them for long, without a decision of a better one: now it decides."""
    named: Id = ""
    """The id of the robot that its words name."""
    answers: Id = ""
    """The decision: the id of the robot that answers."""
    says: Annotated[str, Field(max_length=MOST_SAID)] = ""
    """The text, if it is not a person's utterance but the robot's own."""
    leaving: bool = False

    @property
    def rank(self) -> tuple[bool, bool, float, str]:
        """The sort key; the greatest decides."""
        return (self.waited, self.asked, self.level_db, self.id)


_CLAIM = TypeAdapter(Claim)


def read_claim(text: str) -> Claim:
    """Read a claim from JSON. Raises `InvalidValue`."""
    return read_message(_CLAIM, text, "hearers", MAX_CHARACTERS)


@dataclass(frozen=True, slots=True)
class UtteranceHeard:
    """A person has said something to the robot, or paused in it; its words are not known yet."""

    began_s: float
    """The clock's time of the first voiced sample."""
    ended_s: float
    """The clock's time of the last voiced sample."""
    stands_out_db: float
    """Decibels by which it exceeds the noise: how well the robot hears it."""
    woken_s: float | None = None
    """The clock's time when the wake word was heard; None without one."""
    asked: bool = False
    """True if the robot has asked a question that it may answer."""


@dataclass(frozen=True, slots=True)
class Span:
    """The time of an utterance, by this robot's clock."""

    began_s: float
    ended_s: float
    woken_s: float | None

    def is_same(self, other: "Span") -> bool:
        """Whether both are of one utterance."""
        woken = [one.woken_s for one in (self, other) if one.woken_s is not None]
        if len(woken) > 1 and abs(woken[0] - woken[1]) > SAME_WAKE_S:
            return False
        common_s = min(self.ended_s, other.ended_s) - max(self.began_s, other.began_s)
        shorter_s = min(self.ended_s - self.began_s, other.ended_s - other.began_s)
        return common_s >= OVERLAP * max(LEAST_S, shorter_s)


@dataclass(slots=True)
class _Robot:
    """Another robot of the group."""

    name: str
    beat: int
    """This robot's beat when it was last heard."""
    claims: "dict[int, tuple[Claim, Span, int]]" = field(default_factory=dict)
    """Its last claim of each utterance, with this robot's beat at that time."""


@dataclass(slots=True)
class _Utterance:
    """An utterance that this robot has heard."""

    span: Span
    claim: Claim
    sent_beat: int
    """The first beat with the present claim."""
    claimed: bool = False
    """Whether it is known how well it was heard."""
    words_beat: int | None = None
    words_s: float = 0.0
    text: str = ""
    doubted: bool = False
    """Whether its words may hold a name that was misheard."""
    then: "Callable[[str], None] | None" = None
    decided_beat: int | None = None


Settled = tuple[Callable[[str], None], str]


class Hearers:
    """The robots of a group that hear the same utterance, and this one's part. Any thread."""

    def __init__(
        self, name: str, group: str, clock: Clock | None = None, robot_id: str = ""
    ) -> None:
        """Join a group under a name. `robot_id` is random by default."""
        self.group = group
        self._clock = clock or SystemClock()
        self._me = Claim(robot_id or secrets.token_hex(4), name[:40], group, 0)
        self._lock = threading.RLock()
        self._robots: dict[str, _Robot] = {}
        self._utterances: list[_Utterance] = []
        self._numbers = 0
        self._speech: _Utterance | None = None
        self._said = ""
        self._sent_beat = self._beat = 0
        self._returned_s = self._second_s = float("-inf")
        self._read = 0
        self.dropped = 0
        """Messages that came too fast to be read."""
        self.send: Callable[[str], None] = lambda _: None
        """Publishes a claim as JSON, to this robot also."""

    @property
    def id(self) -> str:
        """The id of this robot in the group."""
        return self._me.id

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the other robots of the group that are here."""
        with self._lock:
            return tuple(sorted(robot.name for robot in self._robots.values()))

    def heard(self, utterance: UtteranceHeard) -> None:
        """Claim an utterance whose words are not known yet."""
        with self._lock:
            span = Span(utterance.began_s, utterance.ended_s, utterance.woken_s)
            one = self._of(span)
            if not one.claimed or one.span != span:
                level_db = round(min(200.0, max(-200.0, utterance.stands_out_db)), 1)
                one.claim = replace(one.claim, level_db=level_db, asked=utterance.asked)
                one.span, one.claimed, one.sent_beat = span, True, self._sent_beat
            told = self._messages([one])
        self._send(told)

    def settle(self, heard: Heard, then: Callable[[str], None]) -> None:
        """Call `then` once it is decided who answers, with the name of the robot.

        The name is empty if it is this one. A robot without another in its group is told at once.
        """
        with self._lock:
            self._forget_absent()
            one = self._of(_span_of(heard))
            one.then, one.words_s, one.words_beat = then, self._clock.now(), self._beat
            one.text = heard.text
            names = {self._me.id: self._me.name}
            names |= {key: robot.name for key, robot in self._robots.items()}
            one.claim = replace(one.claim, words=True, named=named_in(heard.text, names))
            one.doubted = bool(named_in(heard.text, names, MAY_BE))
            settled = self._decide()
            told = self._messages([one])
        self._send(told)
        _tell(settled)

    def withdraw(self, heard: Heard) -> None:
        """Claim this utterance no more: it has no words, or they have stopped the robot."""
        with self._lock:
            began_s = _span_of(heard).began_s
            self._utterances = [
                one
                for one in self._utterances
                if one.span.began_s != began_s or one.then or one.decided_beat is not None
            ]

    def says(self, text: str) -> None:
        """Tell the others what this robot says, or is about to say."""
        with self._lock:
            self._said = f"{self._said} {text}".strip()[-MOST_SAID:]

    def speaks(self, speaking: bool) -> None:
        """Claim the sound from now on as this robot's own, or no longer."""
        with self._lock:
            now_s = self._clock.now()
            if speaking and self._speech is None:
                self._speech = self._of(Span(now_s, now_s, None))
                self._speech.claim = replace(self._speech.claim, answers=self._me.id)
            elif not speaking and self._speech is not None:
                self._extend_speech()
                self._speech.decided_beat = self._sent_beat
                self._speech, self._said = None, ""

    def _extend_speech(self) -> None:
        if one := self._speech:
            one.span = replace(one.span, ended_s=self._clock.now())
            one.claim = replace(one.claim, says=self._said)

    def own_words(self, heard: Heard) -> Heard:
        """The words without this robot's name at their beginning or end."""
        others = (replace(one, text=without_name(one.text, self._me.name)) for one in heard.others)
        text = without_name(heard.text, self._me.name)
        return replace(heard, text=text, others=tuple(others))

    def beat(self) -> None:
        """Tell the others; to be called every `BEAT_S`."""
        with self._lock:
            self._sent_beat += 1
            self._extend_speech()
            told = self._messages(self._telling())
            if not told and self._sent_beat % IDLE_BEATS == 0:
                told = [replace(self._me, beat=self._sent_beat)]
            settled = self._decide()
        self._send(told)
        _tell(settled)

    def hear(self, text: str) -> None:
        """Take a message of the group, this robot's also. Raises `InvalidValue`."""
        if not self._has_time():
            return
        claim = read_claim(text)
        if claim.group != self.group:
            return
        with self._lock:
            if claim.id == self._me.id:
                self._returned(claim.beat)
            else:
                self._take(claim)
            settled = self._decide()
        _tell(settled)

    def leave(self) -> None:
        """Tell the others that this robot leaves."""
        self._send([replace(self._me, leaving=True)])

    def _has_time(self) -> bool:
        now_s = self._clock.now()
        with self._lock:
            if now_s - self._second_s >= 1.0:
                self._second_s, self._read = now_s, 0
            self._read += 1
            self.dropped += self._read > MOST_PER_S
            return self._read <= MOST_PER_S

    def _send(self, claims: Iterable[Claim]) -> None:
        for claim in claims:
            self.send(_CLAIM.dump_json(claim).decode())

    def _of(self, span: Span) -> _Utterance:
        """The utterance that began then; a new one if there is none."""
        for one in self._utterances:
            if one.span.began_s == span.began_s:
                return one
        self._numbers += 1
        claim = replace(self._me, utterance=self._numbers)
        new = _Utterance(span, claim, self._sent_beat)
        decided = [one for one in self._utterances if one.then is None][-MOST_UTTERANCES:]
        waiting = [one for one in self._utterances if one.then is not None]
        self._utterances = [*decided, *waiting, new]
        return new

    def _telling(self) -> list[_Utterance]:
        """The utterances of which the others are still told."""
        oldest_s = self._clock.now() - KEPT_S
        self._utterances = [
            one for one in self._utterances if one.then or one.span.ended_s > oldest_s
        ]
        return [
            one
            for one in self._utterances
            if one.decided_beat is None or self._sent_beat - one.decided_beat <= TOLD_BEATS
        ]

    def _messages(self, utterances: Iterable[_Utterance]) -> list[Claim]:
        now_s = self._clock.now()
        return [
            replace(
                one.claim,
                beat=self._sent_beat,
                ago_ms=_ms(now_s - one.span.ended_s),
                lasted_ms=_ms(one.span.ended_s - one.span.began_s),
                woken_ms=None if one.span.woken_s is None else _ms(now_s - one.span.woken_s),
            )
            for one in utterances
        ]

    def _returned(self, beat: int) -> None:
        """A message of this robot came back: so long has it listened."""
        now_s = self._clock.now()
        self._beat = max(self._beat, min(beat, self._sent_beat))
        if now_s - self._returned_s > HELD_UP_S:
            for one in self._utterances:
                one.sent_beat = self._beat
        self._returned_s = now_s
        self._forget_absent()

    def _forget_absent(self) -> None:
        self._robots = {
            key: robot
            for key, robot in self._robots.items()
            if self._beat - robot.beat < PRESENT_BEATS
        }

    def _take(self, claim: Claim) -> None:
        if claim.leaving:
            self._robots.pop(claim.id, None)
            return
        robot = self._robots.get(claim.id)
        if robot is None:
            if len(self._robots) >= MOST_ROBOTS:
                return
            robot = self._robots[claim.id] = _Robot(claim.name, self._beat)
        robot.name, robot.beat = claim.name, self._beat
        if claim.utterance:
            now_s = self._clock.now()
            ended_s = now_s - claim.ago_ms / 1000
            woken_s = None if claim.woken_ms is None else now_s - claim.woken_ms / 1000
            span = Span(ended_s - claim.lasted_ms / 1000, ended_s, woken_s)
            robot.claims.pop(claim.utterance, None)  # the last one told of stands last
            if not claim.answers:
                self._tell_again(span)
            robot.claims[claim.utterance] = (claim, span, self._beat)
            while len(robot.claims) > MOST_UTTERANCES:
                del robot.claims[next(iter(robot.claims))]

    def _tell_again(self, span: Span) -> None:
        """Repeat the decision about an utterance that a robot still claims."""
        for one in self._utterances:
            if one.claim.answers and one is not self._speech and one.span.is_same(span):
                one.decided_beat = self._sent_beat

    def _rivals(self, one: _Utterance) -> list[tuple[Claim, int]]:
        """The others' claims of the same utterance, and this robot's beat when each came."""
        oldest_s = self._clock.now() - KEPT_S
        return [
            (claim, beat)
            for robot in self._robots.values()
            for claim, span, beat in robot.claims.values()
            if span.ended_s > oldest_s and one.span.is_same(span)
        ]

    def _decide(self) -> list[Settled]:
        settled: list[Settled] = []
        for one in self._utterances:
            if one.then is None:
                continue
            answers = one.claim.answers or self._answerer(one)
            if answers is None:
                continue
            settled.append((one.then, "" if answers == self._me.id else self._name_of(answers)))
            one.then, one.claim = None, replace(one.claim, answers=answers)
            one.decided_beat = one.decided_beat or self._sent_beat
        return settled

    def _name_of(self, robot_id: str) -> str:
        robot = self._robots.get(robot_id)
        return (robot and robot.name) or ANOTHER

    def _answerer(self, one: _Utterance) -> str | None:
        """The id of the robot that answers; None while undecided, empty if it is unknown."""
        if not self._robots:
            return self._me.id
        rivals = self._rivals(one)
        told = [claim.answers for claim, _ in rivals if claim.answers and not claim.says]
        echoed = [claim.answers for claim, _ in rivals if echoes(one.text, claim.says)]
        if told or echoed:
            return (told or echoed)[0]
        rivals = [(claim, beat) for claim, beat in rivals if not claim.says]
        now_s = self._clock.now()
        by_rank = sorted((claim for claim, _ in rivals), key=lambda claim: claim.rank)
        if now_s - one.words_s > LATEST_S or now_s - one.span.ended_s > KEPT_S:
            return ""
        held_up = now_s - self._returned_s > HELD_UP_S
        if held_up or one.words_beat is None or self._beat - one.sent_beat < SETTLE_BEATS:
            return None
        waited = self._beat - one.words_beat
        here = {claim.id: claim for claim, beat in rivals if self._beat - beat < GONE_BEATS}
        if any(claim.rank > one.claim.rank for claim in here.values()):
            if waited >= PATIENCE_BEATS and not one.claim.waited:
                one.claim, one.sent_beat = replace(one.claim, waited=True), self._sent_beat
            return None
        known = {self._me.id, *self._robots}
        named = [claim.named for claim in by_rank if claim.id in here and claim.named in known]
        if called := one.claim.named or (named[-1] if named else ""):
            return called
        unheard = not all(claim.words for claim in here.values())
        if one.doubted and unheard and waited < NAME_BEATS:
            return None
        return self._me.id


def _span_of(heard: Heard) -> Span:
    return Span(heard.first_s, heard.ended_s, None)


def _ms(seconds: float) -> int:
    return round(min(MOST_MS, max(0.0, 1000 * seconds)))


def _tell(settled: Iterable[Settled]) -> None:
    for then, other in settled:
        then(other)
