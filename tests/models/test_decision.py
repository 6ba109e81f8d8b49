"""Templates, readings and their judge together, with the real encoder: what moves, and what not."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import pytest
import yaml
from corpus_robots import is_right, skills_of_robots
from corpus_sentences import Sentence, held_out, read_corpus, tuning

from edgevox.agent.nlu.decider import Decider, Decision
from edgevox.agent.nlu.encoder import ENCODER, Encoder
from edgevox.agent.nlu.head import read_head
from edgevox.agent.nlu.judging import Readings
from edgevox.agent.nlu.meaning import SURE_FROM
from edgevox.agent.nlu.small_talk import CHATS
from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate

NO_ORDERS = yaml.safe_load(Path(__file__).with_name("no_orders.yaml").read_text("utf-8"))


@lru_cache
def ways(robot: str, language: str) -> tuple[Recogniser, Readings]:
    skills = skills_of_robots()[robot]
    return Recogniser(skills, language), Readings(skills, language)


def decide(decider: Decider, sentence: Sentence) -> Decision | None:
    recogniser, readings = ways(sentence.robot, sentence.language)
    if find_stop_word(sentence.language, sentence.says):
        return None
    found = recogniser.recognise(sentence.says)
    if isinstance(found, Understood):
        return Decision(found.calls, 1.0)
    return decider.decide(readings.of(sentence.says), sentence.says)


def moved_wrongly(decider: Decider, sentences: Sequence[Sentence]) -> int:
    wrong = 0
    for one in sentences:
        decision = decide(decider, one)
        if decision and decision.sure and not is_right(one, one.robot, decision.calls):
            skills = skills_of_robots()[one.robot]
            wrong += any(skills[call.skill].drives for call in decision.calls)
    return wrong


@pytest.mark.long
@pytest.mark.parametrize("half", [tuning, held_out])
def test_nobody_is_driven_about_unasked(decider: Decider, half: object) -> None:
    sentences = half(read_corpus())[::4]  # type: ignore[operator]

    assert moved_wrongly(decider, sentences) == 0


@pytest.mark.parametrize("robot", ["robot-apartment", "robot-humanoid"])
@pytest.mark.parametrize("language", NO_ORDERS)
def test_what_is_no_order_begins_no_motion(decider: Decider, language: str, robot: str) -> None:
    skills = skills_of_robots()[robot]

    def moves(says: str) -> bool:
        decision = decide(decider, Sentence(says, robot, language, "none", ((),)))
        called = decision.calls if decision and decision.sure else ()
        return any(skills[call.skill].drives for call in called if call.skill in skills)

    assert [says for says in NO_ORDERS[language] if moves(says)] == []


@pytest.mark.parametrize(
    "says",
    [
        "what is seven times eight",
        "I was in the office yesterday",
        "is the kitchen bigger than the office?",
        "do not go to the bedroom",
        "clean the bathroom",
        "why did you go there?",
        "someone needs to check the stove",
        "go to the garage",
    ],
)
def test_what_once_drove_the_robot_about_does_not_any_more(decider: Decider, says: str) -> None:
    decision = decide(decider, Sentence(says, "robot-apartment", "en", "measured", ((),)))

    assert decision is None or decision.confidence < SURE_FROM


def test_two_readers_of_one_file_agree() -> None:
    one, other = (Encoder(locate(ENCODER)).features("fahr in die K\u00fcche") for _ in range(2))

    assert (one == other).all()


@pytest.mark.parametrize(
    ("says", "general"),
    [
        ("who built the Great Wall", True),
        ("how do I poach an egg", True),
        ("wie lange brüten Hühner", True),
        ("pourquoi les feuilles tombent-elles", True),
        ("富士山の高さはどれくらいですか", True),
        ("is the fridge open", False),
        ("who is on the balcony", False),
        ("when did my uncle call", False),
        ("do you have a soul", False),
        ("wo steht mein Fahrrad", False),
        ("est-ce que tu as peur", False),
        ("私の靴はどこですか", False),
    ],
)
def test_a_model_is_asked_about_the_world_only_in_general(
    decider: Decider, says: str, general: bool
) -> None:
    assert decider.is_general(says) is general


@pytest.mark.parametrize(
    ("says", "kind"),
    [
        ("good evening, robot", "hello"),
        ("thank you so much", "thanks"),
        ("how are you feeling this morning", "how_are_you"),
        ("you are a really clever robot", "praise"),
        ("I am feeling very sad", "sad"),
        ("who has made you?", "robot"),
        ("do you like football?", "feelings"),
        ("tell me a funny joke", "creative"),
        ("does it bother you to be alone all night?", "feelings"),
        ("could I put a question to you?", "here"),
        ("Wie geht es dir heute?", "how_are_you"),
        ("Raconte-moi une histoire drôle", "creative"),
        ("¿Quién te ha hecho?", "robot"),
        ("come stai oggi?", "how_are_you"),
        ("расскажи мне анекдот", "creative"),
        ("今天天气好吗", "outside"),
        ("the kitchen was painted yesterday", None),
        ("who wrote Hamlet?", None),
        ("why is the sky blue?", None),
        ("go to the kitchen", None),
        ("we had lunch with the neighbours", None),
        ("fahr in die Küche", None),
    ],
)
def test_small_talk_is_told_by_its_kind(decider: Decider, says: str, kind: str | None) -> None:
    found, likely = decider.small_talk(says)
    assert (found if likely >= CHATS else None) == kind


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_has_an_answer_to_each_kind_of_small_talk(language: str) -> None:
    sentences = phrasebook(language)
    for kind in read_head().talk.kinds[1:]:
        assert sentences.say(f"talk_{kind}")
