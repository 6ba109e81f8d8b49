"""What a model writes, read as it is written."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.llm.calls import HANDOFF, OutputParser, Protocol
from edgevox.agent.skills import Call, Example, GoalHandle, SkillSet, skill


@skill(examples=[Example("look at the stove", {"room": "kitchen"})])
def navigate_to(goal: GoalHandle, room: str) -> None:
    """Drive to a room."""


@skill(examples=[Example("are you tired?")])
def battery(goal: GoalHandle) -> None:
    """Say how full the battery is."""


PROTOCOL = Protocol("Be kind.", SkillSet([navigate_to, battery]), ("cook",))
CALLS = 'call: navigate_to(room="kitchen"); battery(); done'


def fed(text: str, cuts: list[int]) -> tuple[str, list[Call]]:
    parser = PROTOCOL.parser()
    places = sorted({min(cut, len(text)) for cut in cuts} | {0, len(text)})
    pieces = [text[a:b] for a, b in itertools.pairwise(places)]
    return "".join(parser.feed(piece) for piece in pieces), list(parser.finish())


cuts = st.lists(st.integers(0, 60))


@given(cuts)
def test_words_come_out_whole_however_they_are_cut(where: list[int]) -> None:
    assert fed("talk: Hello (you); call: me.", where) == ("Hello (you); call: me.", [])


@given(cuts)
def test_calls_come_out_in_order_and_are_never_said(where: list[int]) -> None:
    expected = [Call("navigate_to", {"room": "kitchen"}), Call("battery")]

    assert fed(CALLS, where) == ("", expected)


@given(st.text(max_size=200))
def test_no_output_can_break_the_parser(text: str) -> None:
    parser = OutputParser()
    parser.feed(text)
    parser.finish()


@given(st.integers(0, len(CALLS) - 1))
def test_calls_that_were_cut_short_are_not_made_at_all(length: int) -> None:
    assert fed(CALLS[:length], [])[1] == []


def test_words_are_heard_as_soon_as_they_are_written() -> None:
    parser = PROTOCOL.parser()

    assert [parser.feed(p) for p in ("talk", ": Hel", "lo.")] == ["", "Hel", "lo."]


def test_control_characters_are_not_said() -> None:
    assert fed("talk: a\n\x1b[2Jb", [])[0] == "a [2Jb"


def test_a_joint_inside_a_string_is_part_of_it() -> None:
    assert fed('call: navigate_to(room="a; b"); done', [])[1] == [
        Call("navigate_to", {"room": "a; b"})
    ]


def test_a_handoff_is_a_call_like_any_other() -> None:
    assert fed('call: handoff(agent="cook"); done', [])[1] == [Call(HANDOFF, {"agent": "cook"})]
    assert f"{HANDOFF}(" in PROTOCOL.grammar
    assert any(f"{HANDOFF}(" in m.content for m in PROTOCOL.opening if m.role == "assistant")


def test_the_opening_shows_skills_examples_two_calls_small_talk_and_refusals() -> None:
    shown = [m.content for m in PROTOCOL.opening if m.role == "assistant"]

    assert "Be kind." in PROTOCOL.opening[0].content
    assert "navigate_to(room=string): Drive to a room." in PROTOCOL.opening[0].content
    assert 'call: navigate_to(room="kitchen"); done' in shown
    assert any(answer.count(";") == 2 for answer in shown)
    assert any(answer.startswith("talk: Hello") for answer in shown)
    assert any(answer.startswith("talk: Sorry") for answer in shown)
    assert shown[-1].startswith("talk: ")


def test_every_example_answer_is_one_that_the_parser_understands() -> None:
    for message in PROTOCOL.opening[2::2]:
        words, calls = fed(message.content, [])
        assert bool(words) != bool(calls)


def test_number_words_are_digits_before_a_model_sees_them() -> None:
    assert PROTOCOL.prepare("go  to minus two\nand three") == "go to -2 and 3"


def test_an_agent_without_skills_still_talks() -> None:
    alone = Protocol("Be kind.", SkillSet(()))

    assert all("(" not in message.content for message in alone.opening)
