"""Whatever the grammar lets through is words, or calls that their skills accept."""

import random
from typing import Annotated, Literal

import pytest
from gbnf_walk import Walker
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from edgevox.agent.llm.calls import OutputParser, Protocol
from edgevox.agent.llm.grammar import HANDOFF, MAX_MODEL_CALLS, grammar
from edgevox.agent.skills import GoalHandle, OneOf, SkillSet, skill
from edgevox.core.errors import InvalidValue


@skill()
def navigate_to(goal: GoalHandle, room: Annotated[str, OneOf(("kitchen", "living_room"))]) -> None:
    """Drive to a room."""


@skill()
def turn(goal: GoalHandle, degrees: float, slowly: bool = False, times: int = 1) -> None:
    """Turn."""


@skill()
def grip(
    goal: GoalHandle,
    hand: Literal["left", 'the "other" one'] = "left",
    fingers: Annotated[int, Field(ge=2, le=5)] = 2,
    note: str | None = None,
) -> None:
    """Close a hand."""


@skill()
def lift(goal: GoalHandle, metres: Annotated[float, Field(ge=0, lt=1000)]) -> None:
    """Lift."""


@skill()
def stop(goal: GoalHandle) -> None:
    """Stop."""


SKILLS = SkillSet([navigate_to, turn, grip, lift, stop])
HANDOFFS = ("driver", "cook")
GRAMMAR = grammar(SKILLS, HANDOFFS)
seeds = st.integers(0, 2**32 - 1)


def written(seed: int, rule: str = "root") -> str:
    return Walker(GRAMMAR, random.Random(seed)).walk(rule)


def read(text: str) -> tuple[str, tuple]:
    parser = OutputParser()
    words = parser.feed(text)
    return words, tuple(parser.finish())


@given(seeds)
def test_calls_that_the_grammar_allows_are_accepted_by_their_skills(seed: int) -> None:
    words, calls = read("call: " + written(seed, "calls"))

    assert words == ""
    assert 1 <= len(calls) <= MAX_MODEL_CALLS
    for call in calls:
        if call.skill == HANDOFF:
            assert call.arguments["agent"] in HANDOFFS
        else:
            SKILLS[call.skill].validate(call.arguments)


@given(seeds)
def test_an_output_is_either_words_or_calls(seed: int) -> None:
    words, calls = read(written(seed))

    assert bool(words) != bool(calls)


@given(seeds)
def test_words_end_with_a_sentence_and_hold_no_control_characters_and_no_code(seed: int) -> None:
    words, _ = read("talk: " + written(seed, "words"))

    assert words[-1] in ".!?"
    assert words.isprintable()
    assert set(words).isdisjoint("(){}[]<>=;_|`^~")


@given(seeds)
def test_what_was_read_is_rendered_and_read_again_the_same(seed: int) -> None:
    protocol = Protocol("Be kind.", SKILLS, HANDOFFS)
    _, calls = read("call: " + written(seed, "calls"))

    assert read(protocol.render_calls(calls)) == ("", calls)


def test_numbers_have_no_more_digits_than_their_bounds() -> None:
    longest = max(
        len(str(call.arguments["metres"]).partition(".")[0])
        for seed in range(200)
        for call in read("call: " + written(seed, "calls"))[1]
        if call.skill == "lift"
    )

    assert longest == len("999")


def test_without_skills_only_words_are_possible() -> None:
    alone = grammar(SkillSet(()))

    assert "call" not in alone
    assert Walker(alone, random.Random(1)).walk().startswith("talk: ")


def test_an_argument_that_no_grammar_is_known_for_is_refused_by_name() -> None:
    @skill()
    def follow(goal: GoalHandle, points: list[float]) -> None:
        """Follow points."""

    with pytest.raises(InvalidValue, match=r"follow\.points"):
        grammar(SkillSet([follow]))
