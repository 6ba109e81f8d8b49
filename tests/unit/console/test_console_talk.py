"""What a page is told of a conversation."""

from edgevox.console.talk import messages_of
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
