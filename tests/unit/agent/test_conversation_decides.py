"""What words were understood as is told before it is done: the calls, by which stage, how sure."""

from collections.abc import Iterator

import pytest
from support.conversation import Talk

from edgevox.agent.nlu.meaning import ASK_FROM
from edgevox.core.agent_events import Confirmation, ToolCalled
from edgevox.core.commands import TextInput
from edgevox.core.events import Decided, Transcribed


@pytest.fixture
def rig() -> Iterator[Talk]:
    with Talk(hears=True) as talk:
        yield talk


def told(rig: Talk, *kinds: type) -> list[object]:
    """What of these kinds is told from now on, in its order."""
    noted: list[object] = []
    for kind in kinds:
        rig.bus.subscribe(kind, noted.append)
    return noted


def test_a_plain_command_is_by_a_template_and_told_before_it_is_called(rig: Talk) -> None:
    noted = told(rig, Decided, ToolCalled)
    rig.hear("go to the kitchen")
    decided, called = noted
    assert isinstance(decided, Decided)
    assert decided.calls == (("navigate_to", {"room": "kitchen"}),)
    assert (decided.stage, decided.confidence) == ("template", 1.0)
    assert isinstance(called, ToolCalled)
    assert called.turn == decided.turn


def test_what_is_asked_about_was_decided_by_a_reading_that_is_not_sure(rig: Talk) -> None:
    noted = told(rig, Decided, Confirmation)
    rig.hear("kitchen pleas")
    decided = noted[0]
    assert isinstance(decided, Decided)
    assert decided.calls == (("navigate_to", {"room": "kitchen"}),)
    assert (decided.stage, decided.confidence) == ("reading", ASK_FROM)
    assert isinstance(noted[1], Confirmation)


def test_how_sure_the_words_are_is_told_of_what_was_heard_and_of_nothing_typed(rig: Talk) -> None:
    noted = told(rig, Transcribed, Decided)
    rig.hear("where are you", confidence=0.62)
    rig.conversation.submit(TextInput("where are you"))
    rig.settle()
    heard = [one.confidence for one in noted if isinstance(one, Transcribed)]
    assert heard == [0.62, None]
    decided = [one.confidence for one in noted if isinstance(one, Decided)]
    assert decided == [1.0, 1.0]  # that is another question than whether the words are right


def test_words_that_mean_nothing_are_decided_by_nobody(rig: Talk) -> None:
    noted = told(rig, Decided)
    rig.hear("purple elephants sing")
    assert not noted
