"""What a page is told of a conversation."""

import json

from edgevox.console.sockets.messages import MOST_TALK_BYTES, MOST_TURNS, LastTurns, messages_of
from edgevox.core.events import Decided, Outcome, Transcribed, TurnEnded


def test_what_was_heard_comes_with_how_sure_the_words_are() -> None:
    (heard,) = messages_of(Transcribed("go", 3, 0.8))
    assert heard == {"type": "talk", "kind": "heard", "turn": 3, "text": "go", "confidence": 0.8}
    (typed,) = messages_of(Transcribed("go", 4))
    assert typed["confidence"] is None


def test_what_was_decided_comes_with_its_calls_its_stage_and_how_sure() -> None:
    (told,) = messages_of(Decided((("move", {"distance": 1.0}),), "reading", 0.9, 3))
    assert told == {
        "type": "talk",
        "kind": "decided",
        "turn": 3,
        "calls": [{"skill": "move", "arguments": {"distance": 1.0}}],
        "stage": "reading",
        "confidence": 0.9,
    }


def test_an_end_says_what_became_of_it_and_whether_a_model_talked() -> None:
    (by_model,) = messages_of(TurnEnded(3, Outcome.ANSWERED, tokens=12))
    assert (by_model["outcome"], by_model["stage"]) == ("answered", "model")
    (by_phrase,) = messages_of(TurnEnded(4, Outcome.REFUSED))
    assert (by_phrase["outcome"], by_phrase["stage"]) == ("refused", None)
    (by_nobody,) = messages_of(TurnEnded(5))
    assert by_nobody["outcome"] is None


def last_turns(*messages: dict[str, object]) -> list[object]:
    kept = LastTurns()
    for message in messages:
        kept.add(message)
    return kept.messages()


def test_a_page_that_opens_is_told_the_last_turns_without_their_single_words() -> None:
    heard = [{"kind": "heard", "turn": turn, "text": str(turn)} for turn in range(1, 25)]
    token = {"kind": "token", "turn": 24, "text": "I"}
    told = {"kind": "response", "turn": 24, "text": "I am here."}
    assert last_turns(*heard, token, told) == [*heard[-MOST_TURNS:], told]


def test_words_without_a_turn_are_a_turn_of_their_own() -> None:
    stops = [{"kind": "heard", "turn": 0, "text": "stop"}] * (MOST_TURNS + 1)
    assert len(last_turns(*stops)) == MOST_TURNS


def test_an_open_question_is_told_until_it_is_over() -> None:
    asked = {"kind": "asked", "turn": 1, "text": "Shall I go?", "open": True}
    assert last_turns(asked) == [asked]
    assert last_turns(asked, {**asked, "open": False}) == []


def test_of_long_turns_only_the_newest_are_told() -> None:
    long = [{"kind": "response", "turn": turn, "text": "x" * 5000} for turn in range(1, 11)]
    told = last_turns(*long)
    assert told == long[-4:]
    assert len(json.dumps(told)) <= MOST_TALK_BYTES
