"""Dialogue skills: questions and references as plain sentences in every language.

These skills move nothing and stop nothing. A question gets a short answer from the memory of the
dialogue; a reference is replaced by the calls that `DialogueSkills.meant` finds for it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated

from edgevox.agent.agents import Agent, skills_of
from edgevox.agent.dialogue.memory import Dialogue, MotionRecord
from edgevox.agent.dialogue.references import References
from edgevox.agent.known import NOTHING_KNOWN, Known, about_s
from edgevox.agent.nlu.abilities import abilities
from edgevox.agent.nlu.meaning import (
    ASK_FROM,
    BACK,
    REFERENCES,
    RESUME,
    THE_OTHER,
    THERE,
    Again,
    Do,
    Meaning,
    Program,
    calls_of,
    replaced,
)
from edgevox.agent.phrases.phrasebook import Phrasebook, detail
from edgevox.agent.skills import (
    Call,
    GoalHandle,
    OneOf,
    Result,
    Skill,
    SkillFailed,
    SkillSet,
    skill,
)
from edgevox.agent.skills.skill import NewName
from edgevox.agent.text.reasons import because
from edgevox.agent.text.words import as_sentence
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import GoalStatus
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.events import Outcome

MOST_QUOTED = 120
"""Number of characters of a person's words that an answer quotes."""
_PLAIN = "template"
"""The `source` of a plain command."""


LAST_DONE = "what_did_you_do"
WHERE_BEFORE = "where_were_you"
WAY_LEFT = "how_much_further"
OF_DIALOGUE = (
    LAST_DONE, WHERE_BEFORE, WAY_LEFT, "how_long_took", "what_time", "what_date", "who_are_you",
    "which_languages", "do_you_hear_me", "where_is_it", "how_far_is_it",
)  # fmt: skip
"""Names of the facts that every robot has."""


class DialogueAnswers:
    """Answers questions about the conversation, in the language of `phrases`, on any thread."""

    def __init__(
        self,
        dialogue: Dialogue,
        skills: Mapping[str, Skill],
        phrases: Callable[[], Phrasebook],
    ) -> None:
        self._dialogue = dialogue
        self._skills = skills
        self._phrases = phrases

    def doing(self) -> str:
        """A sentence about the running motion and its progress."""
        book, running = self._phrases(), self._dialogue.running()
        if running is None:
            return book.say("idle")
        skill = self._skills[running.skill]
        action = book.acknowledge(skill, running.arguments)
        action = action or book.say("busy", action=book.can(skill))
        if running.progress is not None:
            action = book.say("doing", action=action, percent=round(100 * running.progress))
        return f"{action} {as_sentence(running.told)}".rstrip()

    def why(self) -> str:
        """A sentence about the words behind the last motion and how they were understood."""
        book, moved = self._phrases(), self._dialogue.moved()
        if moved is None:
            return book.say("nothing_done")
        asked = self._dialogue.exchange(moved.turn)
        if asked is None and moved.turn:  # the exchange is forgotten
            return book.say("nothing_done")
        if asked is None or not asked.words:
            return book.say("why_program")
        words = _quoted(asked.meant or asked.words)
        if asked.source == _PLAIN:
            return book.say("why_plain", words=words)
        return book.say("why_read", words=words, percent=round(100 * asked.confidence))

    def heard(self) -> str:
        """A sentence with the words that were heard last, before this question."""
        book, heard = self._phrases(), self._dialogue.heard()
        return book.say("heard", words=_quoted(heard.words)) if heard else book.say("not_heard")

    def can(self) -> tuple[str, str]:
        """A sentence with a few abilities, and a text with all of them if there are more."""
        book = self._phrases()
        if not self._skills:
            return book.say("no_abilities"), ""
        return abilities(book, list(self._skills.values()))


def _quoted(words: str) -> str:
    words = words.rstrip(".。।")
    return words if len(words) <= MOST_QUOTED else f"{words[:MOST_QUOTED]}…"


CAN = "what_can_you_do"
DOING = "what_are_you_doing"
QUESTIONS = (DOING, "why_did_you", "what_did_you_hear", CAN)
ALSO = "this_one_too"
_ASKED_ABOUT = {RESUME, THERE, THE_OTHER}
"""References that may be asked about, so that none is for later."""
DIALOGUE_SKILLS = (*QUESTIONS, *REFERENCES, ALSO)
"""Names of all dialogue skills."""


class DialogueSkills:
    """Gives each agent the dialogue skills and resolves references.

    The attribute `agents` holds the given agents, each with these skills beside its own.
    """

    def __init__(
        self,
        agents: Sequence[Agent],
        bus: Bus,
        clock: Clock,
        phrases: Callable[[], Phrasebook],
        known: Known = NOTHING_KNOWN,
    ) -> None:
        self._skills = skills_of(agents)
        self._phrases = phrases
        facts = {one.name for one in known.facts}
        self._names = frozenset({*DIALOGUE_SKILLS, *OF_DIALOGUE, *facts} - self._skills.keys())
        self._dialogue = Dialogue(
            bus, clock, self._skills, dialogue_skills=self._names, pose=known.pose
        )
        self._facts = (
            *known.facts, *dialogue_facts(self._dialogue, self._skills, phrases, known)
        )  # fmt: skip
        self._references = References(self._dialogue, self._skills)
        self._answers = DialogueAnswers(self._dialogue, self._skills, phrases)
        self.agents = tuple(
            replace(one, dialogue_skills=self._beside(one.skills)) for one in agents
        )

    def only_tells(self, calls: Sequence[Call]) -> bool:
        """True if the calls only ask the robot something: they leave an open question open."""
        return bool(calls) and all(
            (call.skill in self._names and call.skill not in (*REFERENCES, ALSO))
            or (call.skill in self._skills and _only_tells(self._skills[call.skill]))
            for call in calls
        )

    def meant(self, meaning: Meaning | None, turn: Turn) -> Meaning | None:
        """The meaning with calls in place of its references.

        If a reference finds no call, the turn says what is missing, and the result is None: the
        rest of the meaning is not done either.
        """
        if meaning is None:
            return None
        if meaning.program:
            return self._kept(meaning, meaning.program, turn)
        about_dialogue = all(call.skill in DIALOGUE_SKILLS for call in meaning.calls)
        refers = any(call.skill in REFERENCES or call.skill == ALSO for call in meaning.calls)
        try:
            calls = self._all_resolved(meaning.calls)
        except SkillFailed as error:
            self._refuse(error, turn)
            calls = ()
        sure = (meaning.source, meaning.confidence)
        self._dialogue.decided(
            turn.number, *sure, about_dialogue=about_dialogue and not (refers and calls)
        )
        if not calls:
            return None
        if any(call.skill == CAN for call in calls):
            turn.write(self._answers.can()[1])
        said = {call.skill for call in meaning.calls} - self._skills.keys()
        other = THE_OTHER in said and self._references.other_is_unsure()
        reverse = BACK in said and self._references.may_reverse()
        if other or reverse or not said.isdisjoint((RESUME, THERE)):
            meaning = replace(meaning, confidence=min(meaning.confidence, ASK_FROM))
        return replace(meaning, agent=self._owner(meaning.agent, calls), calls=calls)

    def _kept(self, meaning: Meaning, program: Program, turn: Turn) -> Meaning | None:
        """The meaning of a program with calls in place of references: "do that three times"."""
        self._dialogue.decided(
            turn.number, meaning.source, meaning.confidence, about_dialogue=False
        )
        try:
            meant = replaced(program, self._meant_in_program)
        except SkillFailed as error:
            self._refuse(error, turn)
            return None
        if any(call.skill in self._names for call in calls_of(meant)):  # no questions later
            turn.say(self._phrases().say("program_unclear"), Outcome.NOT_UNDERSTOOD)
            return None
        return replace(meaning, program=meant)

    def _meant_in_program(self, leaf: Do | Again) -> Program:
        if isinstance(leaf, Again):
            return self._references.last_motion()
        if _ASKED_ABOUT.intersection(call.skill for call in leaf.calls):
            raise SkillFailed(because("nothing_before"))  # asked about, so not for later
        return Do(self._all_resolved(leaf.calls))

    def _refuse(self, error: SkillFailed, turn: Turn) -> None:
        phrases, why = self._phrases(), error.reason
        turn.say(phrases.refusal(why), Outcome.REFUSED, detail=detail(phrases, why))

    def kept(self, turn: int, program: Program) -> None:
        """Record the program that this turn asked for."""
        self._dialogue.kept(turn, program)

    def confirmed(self, turn: int, asked: int) -> None:
        """Record that this turn said yes to the words of the turn `asked`."""
        self._dialogue.confirmed(turn, asked)

    def _all_resolved(self, calls: Sequence[Call]) -> tuple[Call, ...]:
        parts = (self._resolved(call, calls[:at]) for at, call in enumerate(calls))
        return tuple(one for part in parts for one in part)

    def _resolved(self, call: Call, before: Sequence[Call]) -> Sequence[Call]:
        if call.skill in self._skills:  # a robot's own
            return (call,)
        match call.skill:
            case "again":
                return self._references.again()
            case name if name == BACK:
                return self._references.back()
            case "further":
                return self._references.further()
            case name if name == THERE:
                return self._references.there(before)
            case name if name == RESUME:
                return self._references.resume()
            case name if name == THE_OTHER:
                return self._references.other()
            case name if name == ALSO:
                return self._references.also(str(call.arguments["value"]))
        return (call,)

    def _owner(self, agent: Agent, calls: Sequence[Call]) -> Agent:
        """The agent that has all these skills: this one, or else the first that can."""
        able = (a for a in self.agents if all(call.skill in a.every_skill for call in calls))
        return agent if all(c.skill in agent.every_skill for c in calls) else next(able, agent)

    def _beside(self, skills: SkillSet) -> SkillSet:
        """The dialogue skills whose names this agent does not use itself."""
        dialogue_skills = [_question(name, self._answers) for name in QUESTIONS]
        dialogue_skills += [_reference(name) for name in REFERENCES]
        if any(one.choices for one in skills.values()):
            dialogue_skills.append(_also(_every_choice(skills)))
        dialogue_skills += self._facts
        return SkillSet(one for one in dialogue_skills if one.name not in skills)


def _only_tells(one: Skill) -> bool:
    return not (one.moves or one.lasting or one.confirm)


def _question(name: str, answers: DialogueAnswers) -> Skill:
    asked: Mapping[str, Callable[[], str]] = {
        DOING: answers.doing,
        "why_did_you": answers.why,
        "what_did_you_hear": answers.heard,
        CAN: lambda: answers.can()[0],
    }
    answer = asked[name]

    def ask(goal: GoalHandle) -> Result:
        """Answer a question about the conversation."""
        goal.token.check()
        return {"answer": answer()}

    ask.__name__ = name
    return skill(done="{answer}", moves=False)(ask)


def _reference(name: str) -> Skill:
    def refer(goal: GoalHandle) -> Result:
        """Do what this refers to: `DialogueSkills.meant` puts that in its place."""
        goal.token.check()
        raise SkillFailed(because("nothing_before"))

    refer.__name__ = name
    return skill(moves=False)(refer)


def _also(choices: OneOf) -> Skill:
    def refer(goal: GoalHandle, value: Annotated[str, choices]) -> Result:
        """Do the same with this word: `DialogueSkills.meant` puts that in its place."""
        goal.token.check()
        raise SkillFailed(because("does_not_go", value=value))

    refer.__name__ = ALSO
    return skill(moves=False)(refer)


def _every_choice(skills: SkillSet) -> OneOf:
    """All words that arguments of these skills may be, learned ones included."""
    choices = [one for each in skills.values() for one in each.choices.values()]
    fixed = tuple(dict.fromkeys(word for one in choices for word in one.fixed))
    aliases = {said: word for one in choices for said, word in one.aliases.items()}

    def learned() -> tuple[str, ...]:
        words = dict.fromkeys(word for one in choices for word in one.words)
        return tuple(word for word in words if word not in fixed)

    names = {word: by_code for one in choices for word, by_code in one.names.items()}
    return OneOf(fixed, aliases, learned, names)


def dialogue_facts(
    dialogue: Dialogue,
    skills: Mapping[str, Skill],
    phrases: Callable[[], Phrasebook],
    known: Known,
) -> tuple[Skill, ...]:
    """The facts of `OF_DIALOGUE`: what the conversation can tell of the robot.

    `skills` are all skills of the robot. A fact is a skill that moves nothing; those of bodies are
    in `edgevox/robots/facts.py`. The last ones here are for what nobody told the robot: it says so,
    and a language model invents nothing.
    """
    return (*_past(dialogue, skills, phrases, known), *_today(known), *_self(), *_unknown())


def _past(
    dialogue: Dialogue,
    skills: Mapping[str, Skill],
    phrases: Callable[[], Phrasebook],
    known: Known,
) -> tuple[Skill, ...]:
    @skill(moves=False)
    def what_did_you_do(goal: GoalHandle) -> Result:
        """Say what the robot did last, and how that ended."""
        goal.token.check()
        moved = dialogue.moved()
        if moved is None:
            return {}
        action = _in_words(moved, skills, phrases())
        ended = moved.status
        return {
            "done": action,
            "now": ended is GoalStatus.RUNNING,
            "worked": ended is GoalStatus.SUCCEEDED,
            "stopped": ended is GoalStatus.CANCELLED,
        }

    @skill(moves=False)
    def where_were_you(goal: GoalHandle) -> Result:
        """Say where the robot was before its last motion."""
        goal.token.check()
        start = dialogue.came_from()
        if start is None:
            return {}
        place = known.place_at(start.x_m, start.y_m)
        return {"room": place, "x": round(start.x_m, 2), "y": round(start.y_m, 2)}

    @skill(moves=False)
    def how_much_further(goal: GoalHandle) -> Result:
        """Say how much of the running motion is left."""
        goal.token.check()
        running = dialogue.running()
        if running is None:
            return {}
        way = known.way_left()
        left_s = way.seconds if way else dialogue.left_s(running)
        left = {"left_s": about_s(left_s)} if left_s is not None else {}
        return {"running": True, "metres": way.metres if way else None, **left}

    @skill(moves=False)
    def how_long_took(goal: GoalHandle) -> Result:
        """Say how long the last motion took, or the running one has taken until now."""
        goal.token.check()
        moved, running = dialogue.moved(), dialogue.running()
        took_s = dialogue.took_s(moved) if moved else None
        if took_s is None:
            return {}
        return {"running": moved is running, "ended": moved is not running, "took_s": took_s}

    return what_did_you_do, where_were_you, how_much_further, how_long_took


def _in_words(moved: MotionRecord, skills: Mapping[str, Skill], book: Phrasebook) -> str:
    one = skills[moved.skill]
    return book.acknowledge(one, moved.arguments) or book.say("busy", action=book.can(one))


def _today(known: Known) -> tuple[Skill, ...]:
    @skill(moves=False)
    def what_time(goal: GoalHandle) -> Result:
        """Say what time it is."""
        goal.token.check()
        return {"time": f"{known.today():%H:%M}"}

    @skill(moves=False)
    def what_date(goal: GoalHandle) -> Result:
        """Say which day it is."""
        goal.token.check()
        now = known.today()
        return {"weekday": now.weekday(), "day": now.day, "month": now.month, "year": now.year}

    return what_time, what_date


def _self() -> tuple[Skill, ...]:
    @skill(moves=False)
    def who_are_you(goal: GoalHandle) -> Result:
        """Say what the robot is called."""
        goal.token.check()
        return {}

    @skill(moves=False)
    def which_languages(goal: GoalHandle) -> Result:
        """Say which languages the robot can be set to."""
        goal.token.check()
        return {}

    @skill(moves=False)
    def do_you_hear_me(goal: GoalHandle) -> Result:
        """Say that the robot hears."""
        goal.token.check()
        return {}

    return who_are_you, which_languages, do_you_hear_me


def _unknown() -> tuple[Skill, ...]:
    @skill(moves=False)
    def where_is_it(goal: GoalHandle, what: Annotated[str, NewName()]) -> Result:
        """Say that the robot does not know where something is."""
        goal.token.check()
        return {"what": what}

    @skill(moves=False)
    def how_far_is_it(goal: GoalHandle, what: Annotated[str, NewName()]) -> Result:
        """Say that the robot does not know how far something is."""
        goal.token.check()
        return {"what": what}

    return where_is_it, how_far_is_it
