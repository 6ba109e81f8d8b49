"""What a model writes: words, or the name of a colleague, and nothing that could move a robot."""

import itertools
import random
from typing import Any

import pytest
from gbnf_walk import Walker
from hypothesis import given
from hypothesis import strategies as st
from support.conversation import Eloquent

from edgevox.agent.agents import Agent
from edgevox.agent.llm.protocol import COLLEAGUE, OutputParser, Protocol, grammar
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.skills import NO_SKILLS, GoalHandle, SkillSet, skill
from edgevox.agent.turn import Turn
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock

HANDOFFS = ("driver", "cook")
PROTOCOL = Protocol("Be kind.", HANDOFFS)
cuts = st.lists(st.integers(0, 60))
seeds = st.integers(0, 2**32 - 1)


def fed(text: str, where: list[int]) -> tuple[str, str]:
    parser = OutputParser()
    places = sorted({min(cut, len(text)) for cut in where} | {0, len(text)})
    pieces = [text[a:b] for a, b in itertools.pairwise(places)]
    return "".join(parser.feed(piece) for piece in pieces), parser.finish()


def written(seed: int) -> str:
    return Walker(PROTOCOL.grammar, random.Random(seed)).walk("root")


@given(cuts)
def test_words_come_out_whole_however_they_are_cut(where: list[int]) -> None:
    assert fed("talk: Hello (you); colleague: me.", where) == (
        "Hello (you); colleague: me.",
        "",
    )


@given(cuts)
def test_a_hand_over_is_never_said(where: list[int]) -> None:
    assert fed("colleague: cook", where) == ("", "cook")


@given(st.text(max_size=200))
def test_no_output_can_break_the_parser(text: str) -> None:
    words, name = fed(text, [])

    assert not (words and name)
    assert words.isprintable() or not words.isascii()


def test_words_are_heard_as_soon_as_they_are_written() -> None:
    parser = OutputParser()

    assert [parser.feed(p) for p in ("talk", ": Hel", "lo.")] == ["", "Hel", "lo."]


def test_control_characters_are_not_said() -> None:
    assert fed("talk: a\n\x1b[2Jb", [])[0] == "a [2Jb"


@given(seeds)
def test_an_output_is_either_words_or_a_known_colleague(seed: int) -> None:
    words, name = fed(written(seed), [])

    assert bool(words) != bool(name)
    assert name in ("", *HANDOFFS)


@given(seeds)
def test_words_end_with_a_sentence_and_hold_no_control_characters_and_no_code(seed: int) -> None:
    words, _ = fed("talk: " + Walker(PROTOCOL.grammar, random.Random(seed)).walk("words"), [])

    assert words[-1] in ".!?"
    assert words.isprintable()
    assert set(words).isdisjoint("(){}[]<>=;_|`^~")


def test_without_colleagues_only_words_are_possible() -> None:
    assert COLLEAGUE not in grammar()
    assert COLLEAGUE not in Protocol("Be kind.", ("cook",)).without(["cook"]).grammar


def test_the_opening_has_the_role_examples_and_how_to_hand_over() -> None:
    shown = [m.content for m in PROTOCOL.opening if m.role == "assistant"]

    assert "Be kind." in PROTOCOL.opening[0].content
    assert "colleague: cook" in shown
    assert shown[-1].startswith("talk: ")
    assert all(any(fed(one, [])) for one in shown)


class Asked(Eloquent):
    """Counts how often it is asked."""

    asked = 0

    def generate(self, *args: Any, **more: Any) -> Any:
        self.asked += 1
        return super().generate(*args, **more)


@skill()
def take_note(goal: GoalHandle, text: str) -> None:
    """Write something down."""


@pytest.mark.parametrize(
    "writes",
    ['call: take_note(text="the milk is empty"); done', "colleague: cook", "colleague: robot"],
)
def test_nothing_that_a_model_writes_is_done(writes: str) -> None:
    agent, model = Agent("robot", "", SkillSet([take_note])), Asked(writes)
    interpreter = Interpreter([agent], Bus(), SystemClock(), model)
    turn = Turn(1, Bus(), SystemClock(), on_speech=lambda: None)

    assert interpreter.understand("why does ice float", turn) is None
    assert model.asked == 1
    assert interpreter.active is agent
    assert writes not in turn.text


def test_two_agents_do_not_hand_over_forever() -> None:
    agents = [Agent(a, "", NO_SKILLS, handoffs=(b,)) for a, b in (HANDOFFS, HANDOFFS[::-1])]
    interpreter = Interpreter(agents, Bus(), SystemClock(), Eloquent("colleague: cook"))
    turn = Turn(1, Bus(), SystemClock(), on_speech=lambda: None)

    assert interpreter.understand("why does ice float", turn) is None
    assert interpreter.active.name == "cook"
    assert turn.text
