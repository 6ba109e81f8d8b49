from textwrap import dedent

import pytest

from edgevox.agent.nlu.templates import Recogniser, Understood
from edgevox.agent.phrases.load import OwnPhrases, phrasebook
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.errors import InvalidValue

ENGLISH = """
    [skills.dance]
    can = "dance"
    templates = ["[please] dance [for] {seconds} seconds"]
    says = "Dancing for {seconds:g} seconds."
    action = "dance for {seconds:g} seconds"
    done = ["I have danced {rounds} rounds.", "I have danced."]

    [reasons]
    floor_wet = "The floor of {room} is wet."
"""
GERMAN = """
    [skills.dance]
    can = "tanzen"
    templates = ["tanz [bitte] {seconds} Sekunden"]
    says = "Ich tanze {seconds:g} Sekunden."
    action = "{seconds:g} Sekunden tanzen"
    done = "Ich habe getanzt."

    [reasons]
    floor_wet = "der Boden ist nass: {room}"
"""


def written(folder, **files):
    for code, text in files.items():
        (folder / f"{code}.toml").write_text(dedent(text), "utf-8")
    return folder


@pytest.fixture
def own(tmp_path):
    return OwnPhrases(written(tmp_path, en=ENGLISH, de=GERMAN))


@pytest.fixture
def dance(own):
    @skill(phrases=own.of("dance"))
    def dance(goal, seconds: float):
        """Dance."""

    return dance


@pytest.mark.parametrize(
    ("code", "says", "asks", "done"),
    [
        ("en", "Dancing for 3 seconds.", "Shall I dance for 3 seconds?", "I have danced 2 rounds."),
        ("de", "Ich tanze 3 Sekunden.", "Soll ich 3 Sekunden tanzen?", "Ich habe getanzt."),
        ("fr", "Dancing for 3 seconds.", None, "I have danced 2 rounds."),
    ],
)
def test_a_package_speaks_from_its_own_files_and_english_where_it_has_no_other(
    dance, code, says, asks, done
):
    book, arguments = phrasebook(code), {"seconds": 3.0}

    assert book.acknowledge(dance, arguments) == says
    assert book.report(dance, arguments, {"rounds": 2}) == done
    assert asks is None or book.question([(dance, arguments)]) == asks


@pytest.mark.parametrize(
    ("code", "sentence"), [("en", "please dance for 3 seconds"), ("de", "tanz bitte 3 Sekunden")]
)
def test_a_package_is_understood_by_the_templates_of_its_files(dance, code, sentence):
    found = Recogniser(SkillSet([dance]), code).recognise(sentence)

    assert isinstance(found, Understood)
    assert [call.arguments for call in found.calls] == [{"seconds": 3.0}]


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("en", "I could not do that: The floor of kitchen is wet."),
        ("de", "Das hat nicht geklappt: der Boden ist nass: die Küche."),
        ("fr", "Je n'ai pas pu le faire : The floor of kitchen is wet."),
    ],
)
def test_a_reason_of_a_package_is_said_in_its_languages_and_has_a_code_for_programs(
    own, code, said
):
    why = own.because("floor_wet", room="kitchen")

    assert (why.code, why.values) == ("floor_wet", {"room": "kitchen"})
    assert phrasebook(code).failure(why) == said


@pytest.mark.parametrize(
    ("files", "wrong"),
    [
        ({"en": ENGLISH, "tlh": GERMAN}, "tlh"),
        ({"de": GERMAN}, "en.toml at least"),
        ({"en": ENGLISH, "de": "[reasons]"}, "no floor_wet"),
    ],
)
def test_what_is_wrong_with_the_files_of_a_package_is_named(tmp_path, files, wrong):
    with pytest.raises(InvalidValue, match=wrong):
        OwnPhrases(written(tmp_path, **files))


def test_what_is_said_for_a_truth_stands_in_each_languages_file(tmp_path):
    own = OwnPhrases(
        written(
            tmp_path,
            en="""
            [skills.look]
            templates = ["is the door open"]
            done = "The door is {open}."
            words.open = {true = "open", false = "shut"}
            """,
            de="""
            [skills.look]
            templates = ["ist die Tür auf"]
            done = "Die Tür ist {open}."
            words.open = {true = "auf", false = "zu"}
            """,
        )
    )

    @skill(phrases=own.of("look"))
    def look(goal):
        """Look."""

    for code, open_, said in (
        ("en", True, "The door is open."),
        ("en", False, "The door is shut."),
        ("de", False, "Die Tür ist zu."),
        ("fr", False, "The door is shut."),
    ):
        assert phrasebook(code).report(look, {}, {"open": open_}) == said
