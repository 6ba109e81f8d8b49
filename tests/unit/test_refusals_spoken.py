import re
from contextlib import closing
from typing import Annotated

import pytest
from dialogue_rig import Rig, Walker
from phrasebook_bodies import SKILLS
from pydantic import Field

from edgevox.agent.abilities import abilities, not_understood
from edgevox.agent.nlu.templates import Recogniser, RefusedCommand
from edgevox.agent.own_names import phrasebook_of
from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.skill_executor import MAX_CALLS
from edgevox.agent.skills import OneOf, SkillFailed, SkillPhrases, SkillSet, reason_of, skill
from edgevox.agent.spoken_lists import detail
from edgevox.agent.wrong_arguments import WrongArgument
from edgevox.apps.terminal.view import View
from edgevox.core.agent_events import GoalCancelled, as_json
from edgevox.core.commands import Reset, RunSkill
from edgevox.core.languages import LANGUAGES

PLACES = ("kitchen", "bedroom", "office", "garage", "hallway", "entrance", "cellar", "attic")
WRONG = (1e6, -1e6, 0.5, True, "nonsense", None, [1.0])


def refusals():
    """What is wrong with each argument of each skill, for values of every kind; and without any."""
    for name, one in SKILLS.items():
        for argument in one.arguments_model.model_fields:
            for value in WRONG:
                yield name, one, {argument: value}
        yield name, one, {}
        yield name, one, {"height_m": 5.0}


def raised():
    for name, one, arguments in refusals():
        try:
            one.validate(arguments)
        except (WrongArgument, SkillFailed) as error:
            yield name, arguments, reason_of(error)


@pytest.mark.parametrize("code", LANGUAGES)
def test_what_is_wrong_with_an_argument_is_said_in_the_words_of_the_language(code):
    book, english = phrasebook(code), phrasebook("en")
    heard = set()
    for name, arguments, why in raised():
        said = book.refusal(why)
        heard.add(why.code)
        assert why.code, (name, arguments)
        assert code == "en" or said != english.refusal(why), said
        assert not set("{}_[]") & set(said), said
        assert name.partition(".")[2] not in said, said
        assert not re.search(r"height m\b", said), said
    assert {"too_large", "too_small", "no_number", "missing_argument", "not_one_of"} <= heard


@pytest.mark.parametrize(
    ("code", "said", "answer"),
    [
        (
            "en",
            "walk 30 metres",
            "I cannot do that: the distance in metres may be at most 20, not 30.",
        ),
        (
            "de",
            "walk 30 metres",
            "Das kann ich nicht tun: die Entfernung in Metern darf höchstens 20 sein, nicht 30.",
        ),
        (
            "fr",
            "walk 0 metres",
            (
                "Je ne peux pas faire ça : la distance en mètres doit faire au moins 0,05, "
                "et 0 est trop peu."
            ),
        ),
    ],
)
def test_a_number_beyond_its_bounds_is_refused_with_the_bound(code, said, answer):
    rig = Rig(language=code)
    with closing(rig.talk):
        assert rig.say(said) == answer
        assert rig.body.moves == []


def test_of_many_places_the_nearest_are_said_and_all_are_written():
    rig = Rig(Walker(PLACES))
    with closing(rig.talk):
        answer = rig.hear("go to the celery")

    assert answer.text == (
        "I do not know the room 'celery'. I know cellar, office, kitchen and 5 more."
    )
    assert answer.detail == (
        "I know kitchen, bedroom, office, garage, hallway, entrance, cellar and attic."
    )
    assert answer.written == f"{answer.text} {answer.detail}"


def test_without_a_name_a_few_of_many_places_are_said():
    rig = Rig(Walker(PLACES))
    with closing(rig.talk):
        answer = rig.hear("go to the")

    assert answer.text == ("I did not hear which room. I know kitchen, bedroom, office and 5 more.")


def test_a_program_hears_a_few_of_many_places_too():
    rig = Rig(Walker(PLACES))
    with closing(rig.talk):
        rig.talk.submit(RunSkill("navigate_to", {"room": "gate"}))
        assert rig.talk.wait_idle(10.0)

    (answer,) = rig.answers
    assert answer.text == (
        "I cannot do that: I do not know gate. I know garage, attic, kitchen and 5 more."
    )
    assert "bedroom" in answer.detail


def test_what_is_not_understood_is_one_sentence_and_a_few_examples_and_the_question_are_written():
    rig = Rig(language="de")
    with closing(rig.talk):
        answer = rig.hear("Blorp fizzle.")

    assert answer.text == (
        "Das habe ich nicht verstanden, aber ich kann zum Beispiel in ein Zimmer fahren."
    )
    assert answer.detail == (
        "Ich kann: in ein Zimmer fahren; zu einem Punkt der Karte fahren; vorwärts gehen; "
        "und 3 Dinge mehr. Fragen Sie „Was können Sie tun?“, dann nenne ich alles."
    )


def test_more_calls_than_are_done_at_once_are_refused_in_words():
    rig = Rig(language="de")
    with closing(rig.talk):
        said = rig.say(", then ".join(["go to the kitchen"] * (MAX_CALLS + 1)))

    assert said == ("Das kann ich nicht tun: das sind 9 Dinge auf einmal, und ich tue höchstens 8.")


def test_a_skill_that_there_is_not_is_named_and_those_that_there_are_are_written():
    rig = Rig()
    with closing(rig.talk):
        rig.talk.submit(RunSkill("dance", {}))
        assert rig.talk.wait_idle(10.0)

    (answer,) = rig.answers
    assert answer.text == "I cannot do that: I have not learned dance."
    assert "walk forward" in answer.detail


def test_what_is_only_written_stands_on_the_screen():
    rig, lines = Rig(Walker(PLACES)), []
    view = View(rig.bus, lines.append, lambda: None)
    with closing(rig.talk), closing(view):
        rig.say("go to the celery")

    assert lines[-1].startswith("  I know kitchen, bedroom,")


def test_programs_get_a_code_with_every_goal_that_is_cancelled():
    rig, cancelled = Rig(), []
    rig.bus.subscribe(GoalCancelled, lambda event: cancelled.append(as_json(event)))
    with closing(rig.talk):
        rig.begin("go to the kitchen and go to the office")
        rig.begin("walk 2 metres")
        rig.say("stop")
        rig.begin("walk 3 metres")
        rig.talk.submit(Reset())
        assert rig.talk.wait_idle(10.0)

    found = {(one["skill"], one.get("code"), one["reason"]) for one in cancelled}
    assert found == {
        ("navigate_to", "preempted", "pre-empted by walk_forward"),
        ("navigate_to", "step_ended", "navigate_to cancelled"),
        ("walk_forward", "heard_stop", "heard 'stop'"),
        ("walk_forward", "reset", "reset"),
    }


ODD = "zorkblat"
"""No word of any language: an argument that is called so can only be spoken by mistake."""


def own_skill(**more):
    """A skill of one's own with arguments of every kind, called as no language calls anything."""
    modes = OneOf(("soft", "hard"))

    @skill(templates=["do {zorkblat_mode} {zorkblat_m}"], **more)
    def work(
        goal,
        zorkblat_mode: Annotated[str, modes],
        zorkblat_m: Annotated[float, Field(ge=0.0, le=2.0)],
        zorkblat: Annotated[int, Field(ge=1, le=5)] = 1,
        zorkblat_flag: bool = False,
    ):
        """Do some work."""

    return work


def what_is_said_of(one, book):
    """All that people may hear of a skill: what it can do, asks, begins, ends and refuses."""
    usual = {"zorkblat_mode": "soft", "zorkblat_m": 1.0}
    yield book.can(one)
    yield book.question([(one, usual)])
    yield book.acknowledge(one, usual)
    yield book.report(one, usual, {})
    yield from abilities(book, [one] * 6)
    yield from filter(None, not_understood(book, [one]))
    calls = [{**usual, name: value} for name in one.arguments_model.model_fields for value in WRONG]
    for arguments in (*calls, {}, {"zorkblat_m": 1.0}, {**usual, "zorkblat_x": 5.0}):
        try:
            one.validate(arguments)
        except (WrongArgument, SkillFailed) as error:
            yield book.refusal(reason_of(error))
            yield detail(book, reason_of(error))


@pytest.mark.parametrize("code", LANGUAGES)
def test_what_an_argument_is_called_in_python_is_never_spoken(code):
    one = own_skill()
    said = [*what_is_said_of(one, phrasebook_of(code, [one]))]
    recogniser = Recogniser(SkillSet([one]), code)
    heard = [recogniser.recognise(text) for text in ("do sulky 1", "do")]
    said += [found.reason for found in heard if isinstance(found, RefusedCommand)]

    assert len(said) > 30
    assert not [text for text in said if ODD in text.casefold()]


@pytest.mark.parametrize("code", LANGUAGES)
def test_an_argument_is_spoken_as_its_skill_calls_it_in_the_language(code):
    called = SkillPhrases(arguments={"zorkblat": "GIVEN NAME"})
    one = own_skill(phrases={code: called})
    with pytest.raises(WrongArgument) as caught:
        one.validate({"zorkblat_mode": "soft", "zorkblat_m": 1.0, "zorkblat": 9})

    assert "GIVEN NAME" in phrasebook_of(code, [one]).refusal(reason_of(caught.value))


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_argument_of_our_skills_has_a_name_in_every_language(code):
    book = phrasebook(code)
    for name, one in SKILLS.items():
        for argument in one.arguments_model.model_fields:
            said = book.argument(argument)
            assert len(argument) == 1 or said != book.argument("nobody knows it"), (name, argument)
            assert "_" not in said
