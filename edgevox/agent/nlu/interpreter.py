"""The interpreter, which turns an utterance into calls of skills or into an answer in words.

Templates and readings find the calls. A language model only talks: it answers questions about the
world in general, or hands over to another agent.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from edgevox.agent.agents import Agent, by_name
from edgevox.agent.known import StateCondition
from edgevox.agent.llm.language_model import ChatMessage, LanguageModel
from edgevox.agent.nlu.abilities import abilities, cannot_do, not_understood
from edgevox.agent.nlu.apart import (
    FORGET,
    GUESSES,
    LIKELY_ALONE,
    LIKELY_REFERRED,
    MOST_CLAUSES,
    PLAINLY_ASKED,
    PLAINLY_NOW,
    REFERRED,
    Clause,
    ClauseReader,
    Rest,
    asks_for_motion,
)
from edgevox.agent.nlu.decider import (
    LIKELY_DENIED,
    PERHAPS_NOT_NOW,
    PLAINLY_DENIED,
    TALK,
    Decider,
    Decision,
)
from edgevox.agent.nlu.disfluencies import fluent
from edgevox.agent.nlu.hearing.hypotheses import breaks_off, is_contested, is_same, likeliest
from edgevox.agent.nlu.hearing.near import NearCommands
from edgevox.agent.nlu.hearing.sounds import Phonemes
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.lexicon import words_of
from edgevox.agent.nlu.meaning import (
    ASK_FROM,
    BACK,
    HEARD_FROM,
    REFERENCES,
    THE_OTHER,
    Meaning,
    Program,
)
from edgevox.agent.nlu.model_answer import ModelTalk
from edgevox.agent.nlu.order_reader import NO_CONDITIONS, ProgramReader, Read, Unclear
from edgevox.agent.nlu.questions import (
    LIKELY_TOLD,
    MOST_STRANGE,
    PLAINLY_TOLD,
    WorldWords,
    asks,
    asks_whether,
    cued,
    is_about_hearer,
    question_about,
    question_of,
)
from edgevox.agent.nlu.remainder import may_ask_whether
from edgevox.agent.nlu.small_talk import CHATS, CHATS_PLAINLY, CHATS_SURELY, reply_to, small_talk_in
from edgevox.agent.nlu.splitting import clauses_of, is_taken_back, without_joint
from edgevox.agent.nlu.sums import answer_to_sum
from edgevox.agent.nlu.templates import Recogniser, RefusedCommand, Understood, refused
from edgevox.agent.phrases.load import ENGLISH
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, Skill, SkillSet
from edgevox.agent.stop.words import find_stop_word
from edgevox.agent.text.spelling import key
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import HandedOver
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.commands import as_hypotheses
from edgevox.core.events import Outcome

MAX_HANDOFFS = 3
"""Number of hand-overs of one utterance; no agent gets it twice."""

_SPOKEN = (Outcome.ANSWERED, Outcome.INTERRUPTED)


class Interpreter:
    """Holds the agents, what each understands, and the history. One thread uses it.

    Only `plain` may be called from any thread.
    """

    def __init__(
        self,
        agents: Sequence[Agent],
        bus: Bus,
        clock: Clock,
        model: LanguageModel | None = None,
        language: str = ENGLISH,
        *,
        decider: Decider | None = None,
        phonemes: Phonemes | None = None,
        conditions: Mapping[str, StateCondition] = NO_CONDITIONS,
    ) -> None:
        self._decider = decider
        self._conditions = conditions
        self._phonemes = phonemes
        self._agents = by_name(agents)
        self._bus = bus
        self._clock = clock
        self._talk = ModelTalk(model, agents, phrasebook_of(language, self._every_skill()), clock)
        self.set_language(language)
        self.active = agents[0]

    def set_language(self, code: str) -> None:
        """Understand and answer in this language from now on; `phrases` are its sentences."""
        agents = self._agents.values()
        self._code = code
        self.phrases = phrasebook_of(code, self._every_skill())
        self._recognisers = {a.name: Recogniser(a.skills, code, a.dialogue_skills) for a in agents}
        self._readings = {a.name: Readings(a.skills, code) for a in agents}
        self._questions = {a.name: Readings(_telling(a, self.phrases), code) for a in agents}
        self._near = (
            {a.name: NearCommands(a.skills, self.phrases, self._phonemes) for a in agents}
            if self._phonemes
            else {}
        )
        self._programs = ProgramReader(code, self._conditions)
        self._talk.set_language(self.phrases)

    def chat(self, text: str = "") -> list[ChatMessage]:
        """The messages that the model would see for this utterance."""
        return self._talk.chat(self.active, text)

    def understand(self, text: str, turn: Turn) -> Meaning | None:
        """The meaning of an utterance; None if `turn` has answered it in words."""
        if is_taken_back(text, self._readings[self.active.name].lexicon):
            turn.say(self.phrases.say("left_undone"))
            return None
        meaning = self._understood(text, turn)
        return self._with_little(meaning, text) if meaning else None

    def _with_little(self, meaning: Meaning, text: str) -> Meaning:
        """The meaning, with what "a bit" stands for where no amount was said."""
        skills = meaning.agent.skills
        little = {name: one.little for name, one in skills.items() if one.little}
        bare = [one for one in meaning.calls if not one.arguments and one.skill in little]
        if not bare or not self._readings[meaning.agent.name].says_little(text):
            return meaning
        calls = tuple(Call(o.skill, little[o.skill]) if o in bare else o for o in meaning.calls)
        sure = meaning.confidence if len(meaning.calls) == 1 else min(meaning.confidence, ASK_FROM)
        return replace(meaning, calls=calls, confidence=sure)

    def _understood(self, text: str, turn: Turn) -> Meaning | None:
        plain = self.plain(text)
        said, text = text, fluent(text, self._code)
        asked = self._cued(text)
        if asked and isinstance(plain, Meaning) and _takes_any_words(plain):
            return self._taken(asked, turn)
        if isinstance(plain, Meaning) and not _goes_back_from_there(plain):
            return self._taken(plain, turn)
        program, sure = self._program(said, text)
        if isinstance(program, Program):
            how = ("template", 1.0) if sure else ("reading", ASK_FROM)
            return Meaning(self.active, (), *how, program=program)
        if isinstance(plain, Meaning):
            self._say_unclear(turn)
            return None
        near = None if program else self._sounds_like(text, turn)
        if near and near.sure:
            return self._taken(near, turn)
        meaning = self._judged(text, turn, refused=plain is not None)
        meaning = self._rather(meaning, asked, text, program) if meaning else None
        meaning = self._surely(meaning, text) if meaning else None
        if meaning and (meaning.sure or not near) and not (program and _drives(meaning)):
            return self._taken(meaning, turn)
        if meaning and isinstance(program, Unclear):  # not for now, so not done
            self._say_unclear(turn)
            return None
        if meaning := self._said_instead(text, turn) or near:
            return self._taken(meaning, turn)
        if asked:
            return self._taken(asked, turn)
        beside = None if program else self._apart(text)
        beside = beside or (None if program or plain else self._referred(text))
        if beside:
            return self._taken(self._surely(beside, text), turn)
        refused = program if isinstance(program, RefusedCommand) else plain
        if refused:
            turn.say(refused.reason, Outcome.REFUSED, detail=refused.detail)
            return None
        return self._answer(text, said, turn)

    def joined_to_stop(self, text: str) -> Meaning | None:
        """What the words before a stop word ask for, if it is joined to them; asked about.

        "Turn right, walk half a metre, then (stop)", but not "go to the kitchen, (stop)".
        """
        ordered = without_joint(text, self.phrases.hearing.joints, self._code)
        later = self._decider and self._decider.for_now(ordered) < PERHAPS_NOT_NOW
        if not ordered or later:
            return None
        found = self.opened_by_wait(ordered) or self._read(ordered) or self._apart(ordered)
        return found.heard(0.0) if found else None

    def opened_by_wait(self, text: str) -> Meaning | None:
        """The plain order or program in words that stopped the robot; asked about.

        "Wait ten seconds and then go to the kitchen" is both.
        """
        plain, (program, _) = self.plain(text), self._program(text, text)
        if isinstance(program, Program):
            return Meaning(self.active, (), "reading", ASK_FROM, program=program)
        return plain.heard(0.0) if isinstance(plain, Meaning) else None

    def _program(self, said: str, text: str) -> tuple[Read, bool]:
        """The program in what was said, in its text without false starts, or without remarks."""
        found = self._programs.understand(said, self._plain_calls, self._free_calls)
        if text != said and not isinstance(found[0], Program):  # as said: it may hold words to say
            found = self._programs.understand(text, self._plain_calls, self._free_calls)
        clauses = None if isinstance(found[0], Program) else self._clause_reader(self.active)
        if clauses and (rest := clauses.without_remarks(text)):
            program, _ = self._programs.understand(rest, self._plain_calls, self._free_calls)
            return (program, False) if isinstance(program, Program) else found
        return found

    def _judged(self, text: str, turn: Turn, *, refused: bool) -> Meaning | None:
        """The judged reading; none that only guesses where something better can be said."""
        meaning = self._without_acts(self._without_left(self._read(text), text), text, turn)
        judged = self._readings[meaning.agent.name].of(text) if meaning else None
        if meaning and judged:
            match self._rest_of(text, meaning, corrected=judged.reading.corrected):
                case Rest.ORDER:
                    return None
                case Rest.UNCLEAR:
                    return replace(meaning, confidence=ASK_FROM)
        if meaning and self._only_guesses(meaning):
            strange = judged is not None and judged.evidence["share_strange"] > MOST_STRANGE[0]
            else_asked = self._decider is not None and asks_for_motion(text, self._decider)
            if refused or strange or else_asked or self._small_talk(text):
                return None
            if self._unknown_place(text):
                return None
        return meaning

    def _without_left(self, meaning: Meaning | None, text: str) -> Meaning | None:
        """The reading without drives to places that the words want left; None if none remains."""
        clauses = self._clause_reader(meaning.agent) if meaning else None
        if meaning is None or clauses is None:
            return meaning
        calls = clauses.without_left(text, meaning.calls)
        if calls == meaning.calls:
            return meaning
        sure = min(meaning.confidence, ASK_FROM)
        return replace(meaning, calls=calls, confidence=sure) if calls else None

    def _apart(self, text: str) -> Meaning | None:
        """The motions that the clauses of a text order; what is guessed of them is asked about."""
        clauses = self._clause_reader(self.active)
        if clauses is None:
            return None
        found = clauses.apart(text)
        if found is None:
            return None
        meaning = Meaning(self.active, found.calls, "reading", 1.0 if found.sure else ASK_FROM)
        if _refers_behind(meaning):
            return None
        return meaning if _acts(meaning) or _refers(meaning) else None

    def _referred(self, text: str, least: float = LIKELY_REFERRED) -> Meaning | None:
        """What a text most likely refers to that was done before: "one more time, please".

        None for a text with a name or a number, which changes what was done, and for words that
        deny, tell or put off something, unless they plainly refer.
        """
        if self._decider is None:
            return None
        kind, likely = self._decider.asked(text)
        readings = self._readings[self.active.name]
        if asks(text, self._code) and likely < PLAINLY_ASKED:
            return None
        if REFERRED.get(kind, "") not in self.active.every_skill or likely < least:
            return None
        against = readings.objections(text)
        if REFERRED[kind] == THE_OTHER:  # "no, the other one"
            against -= {*self.phrases.answers.no}
        now = self._decider.for_now(text)
        plainly = likely >= PLAINLY_ASKED and now >= PLAINLY_NOW and not readings.says_little(text)
        if (against and not plainly) or now < PERHAPS_NOT_NOW:
            return None
        if self._world().named_in(text) or readings.has_amount(text):
            return None
        return Meaning(self.active, (Call(REFERRED[kind]),), "reading", ASK_FROM)

    def _surely(self, meaning: Meaning, text: str) -> Meaning:
        """The meaning, done at once if the words plainly order it now."""
        drives = not meaning.sure and _drives(meaning)
        clauses = self._clause_reader(meaning.agent) if drives else None
        asked = asks(text, self._code) or may_ask_whether(meaning.calls, text, self._code)
        if clauses is None or asked:
            return meaning
        plain = clauses.is_plain(text, meaning.calls)
        return replace(meaning, confidence=1.0) if plain else meaning

    def _rather(self, meaning: Meaning, asked: Meaning | None, text: str, program: Read) -> Meaning:
        """A judged meaning, or what the words rather ask or refer to: "again, but the other way".

        A sure motion gives way only to "the other way", and only if no amount or name is said.
        """
        acts = meaning.sure and _acts(meaning)
        if asked and not acts:
            return asked
        said = acts and any(call.arguments for call in meaning.calls)
        referred = None if program or said else self._referred(text, PLAINLY_ASKED)
        if referred and (referred.calls[0].skill == THE_OTHER or not (acts or _drives(meaning))):
            return referred
        return meaning

    def _rest_of(self, text: str, meaning: Meaning, *, corrected: bool) -> Rest:
        """What a text holds beside a sure reading that drives."""
        drives = meaning.sure and _drives(meaning)
        clauses = self._clause_reader(meaning.agent) if drives else None
        if clauses is None:
            return Rest.NOTHING
        return clauses.rest(text, meaning.calls, corrected=corrected)

    def _clause_reader(self, agent: Agent) -> ClauseReader | None:
        """What reads single clauses for an agent; None without a decider."""
        if self._decider is None:
            return None
        return ClauseReader(
            self._decider,
            self._readings[agent.name],
            partial(self._drives_by, agent),
            lambda one: self._cannot(one)[0],
        )

    def _drives_by(self, agent: Agent, text: str) -> Clause | None:
        """A plain command to an agent that drives; without calls if it is refused or does not."""
        plain = self.plain(text)
        if (
            isinstance(plain, Meaning)
            and plain.agent is agent
            and (_drives(plain) or _refers(plain))
        ):
            return Clause(plain.calls, plain.sure)
        refused = isinstance(plain, RefusedCommand)
        return None if plain is None else Clause((), sure=False, refused=refused)

    def _answer(self, text: str, said: str, turn: Turn) -> Meaning | None:
        """Answer words that are no order: by what the robot knows, else by the model.

        `said` are the same words with their false starts.
        """
        if result := answer_to_sum(text, self._code):
            turn.say(result)
            return None
        whether, general = asks_whether(text, self._code), self._is_general(text)
        cannot = "" if general else self._cannot(text)[0]
        least = CHATS_PLAINLY if general else CHATS
        if not (whether or general or cannot) and (told := self._told(text)):
            return self._taken(told, turn)
        if not cannot and (talk := self._small_talk(text, least)):
            turn.say(talk)
            return None
        if not whether and (asked := self._asked(text)):
            return self._taken(asked, turn)
        if cannot:
            turn.say(cannot, Outcome.REFUSED)
            return None
        if whether and not self.active.handoffs:
            self._say_ability(text, turn)
            return None
        if not asks(text, self._code) and (unknown := self._unknown_place(text)):
            turn.say(unknown.reason, Outcome.REFUSED, detail=unknown.detail)
            return None
        private = not general if self._talk.here else is_about_hearer(text, self._code)
        if asks(text, self._code) and (private or self._world().named_in(text)):
            turn.say(self.phrases.say("not_known"))
            return None
        if not self._talk.here:
            self._say_not_understood(text, turn)
            return None
        self._ask_model(said, turn)
        return None

    def plain(self, text: str) -> Meaning | RefusedCommand | None:
        """The meaning or the refusal that the templates alone find; says nothing.

        Words as they were said come first: a name may hold what sounds like a slip.
        """
        found, smooth = self._plainly(text), fluent(text, self._code)
        if isinstance(found, Meaning) and found.sure:
            return found
        found = (self._plainly(smooth) if smooth != text else None) or found
        if isinstance(found, Meaning) and found.sure:
            return found
        return self._plainly_a_little(smooth) or found

    def _plainly_a_little(self, text: str) -> Meaning | None:
        """The motion by a small amount that a text plainly asks for: "back up a bit"."""
        agent = self.active
        rest = self._readings[agent.name].without_little(text)
        found = self._recognisers[agent.name].recognise(rest) if rest else None
        if not isinstance(found, Understood) or found.unsure or len(found.calls) != 1:
            return None
        (call,) = found.calls
        little = agent.every_skill[call.skill].little
        if call.arguments or not little:
            return None
        return Meaning(agent, (Call(call.skill, little),), "template")

    def _plainly(self, text: str) -> Meaning | RefusedCommand | None:
        for agent in self._active_first():
            found = self._recognisers[agent.name].recognise(text)
            if isinstance(found, Understood):
                asks = found.unsure or may_ask_whether(found.calls, text, self._code)
                return Meaning(agent, found.calls, "template", ASK_FROM if asks else 1.0)
            if isinstance(found, RefusedCommand):
                return found
        return None

    def _plain_calls(self, text: str) -> Sequence[Call] | RefusedCommand | None:
        """The calls that `plain` is sure of, for a program to hold."""
        plain = self.plain(text)
        if isinstance(plain, Meaning):
            return plain.calls if plain.sure and not _goes_back_from_there(plain) else None
        return plain

    def _free_calls(self, text: str) -> Sequence[Call] | RefusedCommand | None:
        """The calls that `plain` finds, or those of a sure reading."""
        plain = self.plain(text)
        if isinstance(plain, Meaning) and not _goes_back_from_there(plain):
            return plain.calls
        found = self._plain_calls(text)
        decided = None if isinstance(found, Sequence) else self._decide(text)
        return decided[1].calls if decided and decided[1].sure else found

    def _read(self, text: str) -> Meaning | None:
        """The reading of the first agent that could be meant; None without a decider."""
        if decided := self._decide(text):
            agent, decision = decided
            asks = may_ask_whether(decision.calls, text, self._code)
            sure = min(decision.confidence, ASK_FROM) if asks else decision.confidence
            return Meaning(agent, decision.calls, "reading", sure)
        return None

    def _cannot(self, text: str) -> tuple[str, bool]:
        """The sentences that name what these words ask for and no skill can do; empty for none.

        The second value is True if the robot may be wanted elsewhere for it.
        """
        if asks(text, self._code):
            return "", False
        skills = self._every_skill()
        return cannot_do(
            text, self.phrases, skills, lambda: self._ordered(text), self._names_no_act
        )

    def _names_no_act(self, clause: str, opens: bool) -> bool:
        """True if a clause is a command, or most likely asks for a motion that the robot can do, or
        to forget a place.

        A motion by an amount, or one that needs none: "open the hand". Also for a remark in which
        the words of an act stand behind others (not `opens`): "that's when I take my tablets".
        """
        if isinstance(self._plainly(clause), Meaning):  # "take my picture"
            return True
        if self._decider is None:
            return False
        kind, likely = self._decider.asked(clause)
        own = [one for one in self._every_skill() if one.name in GUESSES.get(kind, ())]
        moves = any(one.relative or not one.arguments_model.model_fields for one in own)
        remark = not opens and kind == TALK and not self._decider.is_order(clause)
        plainly = (remark or (kind == FORGET and own)) and likely >= PLAINLY_ASKED
        return plainly or (moves and likely >= LIKELY_ALONE)

    def _without_acts(self, meaning: Meaning | None, text: str, turn: Turn) -> Meaning | None:
        """The reading, asked about if the words ask for something besides that no skill can do.

        One that only tells something is not what they ask for then.
        """
        guesses = meaning and self._only_guesses(meaning)
        acts = meaning and (guesses or _drives(meaning))
        cannot, elsewhere = self._cannot(text) if acts else ("", False)
        if not meaning or not cannot:
            return meaning
        if guesses or not elsewhere or not any(call.arguments for call in meaning.calls):
            return None
        turn.say(cannot)
        return replace(meaning, confidence=min(meaning.confidence, ASK_FROM))

    def _only_guesses(self, meaning: Meaning) -> bool:
        """True for an unsure meaning that moves and changes nothing, about which nothing asks."""
        skills = meaning.agent.every_skill
        return not meaning.sure and not any(
            skills[call.skill].moves or skills[call.skill].lasting for call in meaning.calls
        )

    def _unknown_place(self, text: str) -> RefusedCommand | None:
        """The refusal of an order to go to a usual place that the robot does not know."""
        for agent in self._active_first():
            found = self._readings[agent.name].unknown_place(text)
            if found and self._ordered(text):
                one, argument, said = found
                return refused(
                    self.phrases, "unknown_word", argument, one.choices[argument].words, said
                )
        return None

    def _ordered(self, text: str) -> bool:
        """True if the encoder takes the words for an order; false without one."""
        return self._decider is not None and self._decider.is_order(text)

    def _is_general(self, text: str) -> bool:
        """True if there is a model that may answer this from general knowledge."""
        if self._decider is None:
            return self._talk.here and not is_about_hearer(text, self._code)
        return self._talk.here and self._decider.is_general(text)

    def _small_talk(self, text: str, least: float = CHATS) -> str:
        """The answer to small talk that names nothing of the robot's world; else empty."""
        if self._decider is None or self._world().named_in(text):
            return ""
        kind = small_talk_in(text, self._code, self._decider, least)
        return self.phrases.say(f"talk_{kind}") if kind else ""

    def _asked(self, text: str) -> Meaning | None:
        """The question to the robot that the words most likely ask, though no template fits."""
        if self._decider and self._decider.told(text)[1] >= LIKELY_TOLD:
            return self._told(text)
        for agent in self._active_first():
            judged = self._questions[agent.name].of(text)
            if call := question_of(judged, text, self._code):
                return Meaning(agent, (call,), "reading", ASK_FROM)
        return None

    def _told(self, text: str) -> Meaning | None:
        """The question to the robot that the encoder is sure of."""
        kind, likely = self._decider.told(text) if self._decider else ("", 0.0)
        plainly = likely >= PLAINLY_TOLD
        if likely < LIKELY_TOLD or self._orders_beside(text, plainly=plainly):
            return None
        for agent in self._active_first():
            lexicon = self._questions[agent.name].lexicon
            if call := question_about(kind, text, lexicon, plainly=plainly):
                return Meaning(agent, (call,), "reading", ASK_FROM)
        return None

    def _cued(self, text: str) -> Meaning | None:
        """The question to the robot whose own words are said, unless another is far likelier."""
        general = partial(self._decider.is_general, text) if self._decider else lambda: False
        for agent in self._active_first():
            if call := cued(text, self._questions[agent.name].lexicon, general):
                chats = self._decider and self._decider.small_talk(text)[1] >= CHATS_SURELY
                if chats or self._orders_beside(text):
                    return None
                return self._told(text) or Meaning(agent, (call,), "reading", ASK_FROM)
        return None

    def _orders_beside(self, text: str, *, plainly: bool = False) -> bool:
        """True if a clause beside a question orders a motion: "go to the kitchen and tell ...".

        False for a text that is `plainly` a question and as a whole asks for no motion: "how far is
        it from here to the kitchen".
        """
        if self._decider is None or (plainly and not asks_for_motion(text, self._decider)):
            return False
        clauses = clauses_of(text, self._code, self.phrases.hearing.joints)
        return 1 < len(clauses) <= MOST_CLAUSES and any(
            self._decider.is_order(one) and asks_for_motion(one, self._decider)
            for one in clauses
            if not asks(one, self._code)
        )

    def as_heard(self, meaning: Meaning, text: str, turn: Turn) -> Meaning:
        """The meaning of a text, unsure if it was hardly heard or another order is as likely."""
        if breaks_off(meaning, text, turn.others, self.plain):
            return meaning.heard(0.0)
        contested = is_contested(meaning, turn.others, self.plain)
        if (contested or turn.hearing < HEARD_FROM) and self._is_rated_best(meaning, text, turn):
            return meaning
        return meaning.heard(0.0 if contested else turn.hearing)

    def _is_rated_best(self, meaning: Meaning, text: str, turn: Turn) -> bool:
        """True if the sound is far more like these words than like any other command."""
        near = self._near.get(meaning.agent.name)
        if near is None or turn.rate is None:
            return False
        best = near.nearest(as_hypotheses(text, turn.hearing, turn.others), turn.rate)
        return (
            best is not None
            and best.sure
            and is_same(replace(meaning, calls=(best.call,)), meaning)
        )

    def _said_instead(self, text: str, turn: Turn) -> Meaning | None:
        """The plain command among the other hypotheses; None for words that deny or put off.

        Where the words lack a value, or name another thing, it is asked about.
        """
        found = likeliest(turn.others, self.plain)
        if found is None or not self.is_held_back(text):
            return found
        if any(self._readings[agent.name].objections(text) for agent in self._active_first()):
            return None
        return found.heard(0.0)

    def _sounds_like(self, text: str, turn: Turn) -> Meaning | None:
        """The command that meaningless spoken words sound like.

        None for typed words, for an act that no skill does, and for words that deny, tell or put
        off something, where the command does not.
        """
        if not turn.way.spoken or self._cannot(text)[0]:
            return None
        several = as_hypotheses(text, turn.hearing, turn.others)
        for agent in self._active_first():
            near = (
                self._near[agent.name].nearest(several, turn.rate)
                if agent.name in self._near
                else None
            )
            if near is None or self._objects(agent, {text, near.heard.text}, near.words):
                continue
            heard = max(near.heard.confidence, turn.hearing) >= HEARD_FROM
            # Words that were heard well are what was said, unless they are hardly more than a name.
            if near.likely or not heard or (near.alone and not self.is_held_back(text)):
                sure = near.sure and not near.alone
                return Meaning(agent, (near.call,), "reading", 1.0 if sure else ASK_FROM)
        return None

    def _objects(self, agent: Agent, heard: Iterable[str], words: str) -> bool:
        """True if something in what was heard speaks against these words, but not in themselves."""
        against = self._readings[agent.name].objections
        return not frozenset().union(*map(against, heard)) <= against(words)

    def named(self, text: str) -> Meaning | None:
        """The plain command in these words, or the one motion by an amount that they only name.

        "Right" names one: beside a motion that is not wanted that says which one is.
        """
        plain = self.plain(text)
        if isinstance(plain, Meaning):
            return plain
        for agent in self._active_first() if plain is None else ():
            if call := self._readings[agent.name].named(text):
                return Meaning(agent, (call,), "reading", ASK_FROM)
        return None

    def denied(self, text: str) -> Call | None:
        """The one call that these words deny and say nothing beside: "don't turn left"."""
        denied = (self._readings[agent.name].denied(text) for agent in self._active_first())
        found = next(filter(None, denied), None)
        if found or self.phrases.hearing.spaced:
            return found
        words = (*words_of(self._code).negations, *self.phrases.answers.not_)
        for one in sorted(words, key=len, reverse=True):
            plain = self.plain(text.replace(one, "", 1)) if one in text else None
            if isinstance(plain, Meaning) and len(plain.calls) == 1:
                return plain.calls[0]
        return None

    def denies_motion(self, text: str) -> bool:
        """True for words that most likely deny a motion, and are no plain command.

        They speak of a motion, or plainly to the robot: "you need not go there", "not there".
        """
        likely = self._decider.denied(text) if self._decider else 0.0
        if likely < LIKELY_DENIED or self.plain(text) is not None:
            return False
        several = [self._readings[agent.name] for agent in self._active_first()]
        to_hearer = is_about_hearer(text, self._code) or any(
            one.opens_denying(text) for one in several
        )
        return any(one.speaks(text) for one in several) or (to_hearer and likely >= PLAINLY_DENIED)

    def is_held_back(self, text: str) -> bool:
        """True if these words say that they are no order, or not for now."""
        for readings in (self._readings[agent.name] for agent in self._active_first()):
            judged = readings.of(text)
            if readings.hold_back(text) or (judged is not None and judged.held_back):
                return True
        return False

    def _decide(self, text: str) -> tuple[Agent, Decision] | None:
        if self._decider is None:
            return None
        for agent in self._active_first():
            decision = self._decider.decide(self._readings[agent.name].of(text), text)
            if decision:
                return agent, decision
        return None

    def remember(self, said: str, turn: Turn, meaning: Meaning | None) -> None:
        """Add a general question and its answer; all else would only slow the next answer."""
        spoken = meaning is None and turn.tokens and turn.outcome in _SPOKEN
        if spoken and self._is_general(said):
            self._talk.remember(self.active, said, turn)

    def forget(self) -> None:
        """Clear the history and go back to the first agent."""
        self._talk.forget()
        self.active = next(iter(self._agents.values()))

    def _ask_model(self, text: str, turn: Turn) -> None:
        """Have the model answer a general question, or hand over to the agent that is to answer."""
        general, claims = self._is_general(text), self._claims(text)
        had: list[str] = []  # so that two agents cannot hand over forever
        while len(had) <= MAX_HANDOFFS:
            had.append(self.active.name)
            asks = general or not set(self.active.handoffs).issubset(had)
            name = self._talk.answer(self.active, had, text, turn, claims) if asks else ""
            if not name:
                self._say_unknown(text, turn)
                return
            self._hand_over(self._agents[name], turn)
        turn.say(self.phrases.say("nobody"), Outcome.FAILED)

    def _say_unclear(self, turn: Turn) -> None:
        turn.say(self.phrases.say("program_unclear"), Outcome.NOT_UNDERSTOOD)

    def _world(self) -> WorldWords:
        return WorldWords(self._every_skill(), self.phrases)

    def _say_ability(self, text: str, turn: Turn) -> None:
        """Say what the robot can, and that it cannot what was asked for: not to "can you walk"."""
        can, detail = abilities(self.phrases, self._every_skill())
        known = any(readings.knows(text) for readings in self._readings.values())
        told = "" if known else self.phrases.say("no_ability")
        turn.say(f"{told} {can}".strip(), detail=detail)

    def _say_unknown(self, text: str, turn: Turn) -> None:
        """Say that this is not known or not understood, unless something was said."""
        if turn.text or turn.token.cancelled:
            return
        if asks(text, self._code) or (self._is_general(text) and not self._ordered(text)):
            turn.say(self.phrases.say("not_known"))
        else:
            self._say_not_understood(text, turn)

    def _say_not_understood(self, text: str, turn: Turn) -> None:
        """Say that the robot leaves, or does not do that, has no answer, or did not understand."""
        parted = clauses_of(text, self._code, self.phrases.hearing.joints)
        readings, no = self._readings[self.active.name], {key(o) for o in self.phrases.answers.no}
        alone = sum(not (readings.is_filler(o) or key(o) in no) for o in parted) == 1
        if alone and not find_stop_word(self._code, text) and self.denies_motion(text):
            turn.say(self.phrases.say("left_undone"))
            return
        told, can = not_understood(self.phrases, self._every_skill())
        speaks = self._readings[self.active.name].speaks(text)
        match reply_to(text, self._code, self._decider, speaks=speaks):
            case "no_ability" if not self._world().named_in(text):
                turn.say(self.phrases.say("no_ability"), Outcome.REFUSED, detail=can)
            case "not_known" | "no_answer" as reply:
                turn.say(self.phrases.say(reply), Outcome.NOT_UNDERSTOOD)
            case _:
                turn.say(told, Outcome.NOT_UNDERSTOOD, detail=can)

    def _claims(self, text: str) -> Callable[[str], bool]:
        """Tells which sentences of an answer to these words claim what no model knows."""
        world = self._world()
        about = asks(text, self._code) and is_about_hearer(text, self._code)
        return lambda said: world.claims_for_itself(said) or (about and world.claimed_in(said))

    def _taken(self, meaning: Meaning, turn: Turn) -> Meaning:
        """The meaning, after a hand-over to its agent."""
        self._hand_over(meaning.agent, turn)
        return meaning

    def _hand_over(self, agent: Agent, turn: Turn) -> None:
        if agent is self.active:
            return
        self._bus.publish(HandedOver(self.active.name, agent.name, turn.number))
        self.active = agent

    def _active_first(self) -> Sequence[Agent]:
        return [self.active, *(a for a in self._agents.values() if a is not self.active)]

    def _every_skill(self) -> Sequence[Skill]:
        return [one for agent in self._agents.values() for one in agent.skills.values()]


def _drives(meaning: Meaning) -> bool:
    return any(meaning.agent.every_skill[call.skill].drives for call in meaning.calls)


def _refers(meaning: Meaning) -> bool:
    return all(call.skill in REFERENCES for call in meaning.calls)


def _acts(meaning: Meaning) -> bool:
    skills = [meaning.agent.every_skill[call.skill] for call in meaning.calls]
    return any(one.moves or one.lasting for one in skills)


def _takes_any_words(meaning: Meaning) -> bool:
    skills = [meaning.agent.every_skill[call.skill] for call in meaning.calls]
    return not _acts(meaning) and any(one.new_names for one in skills)


def _goes_back_from_there(meaning: Meaning) -> bool:
    """True if going back follows another call: then it means the start of that call's motion."""
    return any(call.skill == BACK for call in meaning.calls[1:])


def _refers_behind(meaning: Meaning) -> bool:
    """True if another reference than the first call stands in a meaning: to what, is not plain."""
    return any(call.skill in REFERENCES for call in meaning.calls[1:])


def _telling(agent: Agent, book: Phrasebook) -> SkillSet:
    """The skills that only tell something and can be read by their words alone."""
    return SkillSet(
        one
        for one in agent.every_skill.values()
        if book.tells(one) and not (one.moves or one.lasting or one.new_names)
    )
