"""What people say, run through the templates and through the model of the small set."""

from collections.abc import Sequence

import pytest
import understanding
from understanding import Outcome, share_right

from edgevox.agent.mind import ANSWER_TOKENS, Mind
from edgevox.agent.toolcalls import Protocol
from edgevox.apps.robots import build_agents
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.robots.apartment import ApartmentRobot
from edgevox.robots.plugin import INSTRUCTIONS

PROMISED_SHARE = 0.95
MOST_PROMPT_TOKENS = 800


@pytest.fixture(scope="module")
def by_model(apartment) -> Sequence[Outcome]:
    return apartment.understands([c for c in understanding.read_commands() if c.by == "model"])


@pytest.fixture(scope="module")
def by_template() -> Sequence[Outcome]:
    commands = [c for c in understanding.read_commands() if c.by == "template"]
    return understanding.through_templates(understanding.apartment_skills(), commands)


def test_templates_keep_what_they_promise(by_template: Sequence[Outcome]) -> None:
    assert share_right(by_template) >= PROMISED_SHARE


def test_no_command_yields_an_invalid_call(
    by_model: Sequence[Outcome], by_template: Sequence[Outcome]
) -> None:
    assert [o for o in (*by_model, *by_template) if o.invalid] == []


def test_an_answer_in_words_never_shows_a_call(by_model: Sequence[Outcome]) -> None:
    shown = [o.words for o in by_model if "(" in o.words or "call:" in o.words]

    assert shown == []


def test_an_answer_in_words_ends_at_a_sentence_or_at_the_limit(
    by_model: Sequence[Outcome],
) -> None:
    spoken = [o for o in by_model if o.words]

    assert spoken
    assert all(o.words[-1] in ".!?" or o.pieces >= ANSWER_TOKENS - 4 for o in spoken)


def test_the_prompt_stays_small_enough_to_be_primed_in_seconds(small) -> None:
    mind = Mind(build_agents(ApartmentRobot()), Bus(), SystemClock(), small)

    tokens = sum(small.count_tokens(message.content) + 5 for message in mind.chat())

    assert tokens <= MOST_PROMPT_TOKENS


def test_there_are_sixty_commands_and_more_of_many_kinds() -> None:
    commands = understanding.read_commands()

    assert len({c.says for c in commands}) == len(commands) >= 60
    assert len({c.category for c in commands}) >= 8


def test_the_model_is_never_shown_what_it_is_asked() -> None:
    protocol = Protocol(INSTRUCTIONS, understanding.apartment_skills())

    shown = {plain(m.content) for m in protocol.opening if m.role == "user"}

    assert shown.isdisjoint(plain(c.says) for c in understanding.read_commands())


def plain(sentence: str) -> str:
    return "".join(c for c in sentence.casefold() if c.isalnum() or c == " ").strip()
