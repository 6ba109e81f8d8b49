"""No, the bedroom: understood after a question and after a wrong start."""

import pytest
from confirmation_rig import Talk

from edgevox.agent.last_drive import CORRECTED_S
from edgevox.agent.phrase_file import phrasebook
from edgevox.core.commands import Reset, TextInput
from edgevox.core.languages import LANGUAGES

KITCHEN = {
    "en": "Go to the kitchen.", "de": "Fahr in die Küche.", "fr": "Va à la cuisine.",
    "es": "Ve a la cocina.", "it": "Vai in cucina.", "pt": "Vá para a cozinha.",
    "nl": "Ga naar de keuken.", "pl": "Jedź do kuchni.", "ru": "Поезжай на кухню.",
    "tr": "Mutfağa git.", "ar": "اذهب إلى المطبخ.", "id": "Pergi ke dapur.",
    "hi": "रसोई में जाओ।", "vi": "Đi vào bếp.", "zh": "去厨房。", "ja": "キッチンに行って。",
}  # fmt: skip
OFFICE = {
    "en": ["No, the office.", "no to the office", "No, not the kitchen, the office!",
           "nope, I meant the office", "No, go to the office instead, please."],
    "de": ["Nein, ins Büro.", "nein das Büro", "Nein, nicht in die Küche, sondern ins Büro.",
           "nee, lieber ins Arbeitszimmer", "Nein, fahr bitte ins Büro."],
    "fr": ["Non, au bureau.", "non le bureau", "Non, pas à la cuisine, au bureau.",
           "Non, je voulais dire le bureau."],
    "es": ["No, a la oficina.", "no, el despacho", "No, quise decir el despacho, por favor."],
    "it": ["No, nello studio.", "no in ufficio", "No, non in cucina, nello studio."],
    "pt": ["Não, para o escritório.", "não, o escritório", "Não, eu disse o escritório."],
    "nl": ["Nee, naar het kantoor.", "nee het kantoor", "Nee, niet de keuken, het kantoor."],
    "pl": ["Nie, do gabinetu.", "nie, biuro", "Nie, chodziło mi o gabinet."],
    "ru": ["Нет, в кабинет.", "нет, офис", "Нет, я имел в виду кабинет."],
    "tr": ["Hayır, ofise.", "hayır, çalışma odası", "Hayır, mutfağa değil, ofise."],
    "ar": ["لا، إلى المكتب.", "لا، أقصد المكتب."],
    "id": ["Tidak, ke kantor.", "bukan, ruang kerja", "Tidak, maksud saya kantor."],
    "hi": ["नहीं, दफ़्तर में।", "नहीं, ऑफिस", "नहीं, मेरा मतलब दफ़्तर।"],
    "vi": ["Không, đến văn phòng.", "không, phòng làm việc", "Không phải, ý tôi là văn phòng."],
    "zh": ["不，去书房。", "不是，是办公室。", "不对，我说的是书房"],
    "ja": ["いいえ、書斎へ。", "いや、オフィス", "違います、書斎です。",
           "いえ、キッチンじゃなくて書斎"],
}  # fmt: skip
SAID = [(code, text) for code, texts in OFFICE.items() for text in texts]


def test_every_language_is_looked_at_here():
    assert OFFICE.keys() == KITCHEN.keys() == LANGUAGES.keys()


@pytest.mark.parametrize(("code", "text"), SAID)
def test_another_place_is_understood_after_a_question(code, text):
    with Talk(language=code) as talk:
        talk.say(KITCHEN[code])
        talk.conversation.set_confirm("unsure")
        talk.say(text)
        assert talk.statuses == ["asked", "declined"]
        assert talk.body.sent == ["office"]


@pytest.mark.parametrize(("code", "text"), SAID)
def test_another_place_is_understood_after_a_wrong_start_and_goes_there_instead(code, text):
    with Talk("unsure", language=code) as talk:
        talk.body.drive_on()
        talk.conversation.submit(TextInput(KITCHEN[code]))
        talk.body.starts()
        talk.conversation.submit(TextInput(text))
        talk.body.starts()
        talk.body.arrive()
        assert talk.conversation.wait_idle(60)
        assert talk.body.sent == ["kitchen", "office"]


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_room_is_understood_in_every_form_that_its_phrasebook_has(code):
    book = phrasebook(code)
    forms = [("office", form) for form in _forms(book, "office")]
    forms += [("bedroom", form) for form in _forms(book, "bedroom")]
    no = book.answers.no[0]
    with Talk(language=code) as talk:
        for room, form in forms:
            talk.conversation.set_confirm("always")
            talk.say(KITCHEN[code])
            talk.conversation.set_confirm("unsure")
            talk.say(f"{no}, {form}")
            assert talk.body.sent[-1:] == [room], form


def _forms(book, room):
    word = book.word(room)
    return {word.name, word.to, *word.heard} if book.fallback else {f"the {room}", f"to the {room}"}


def test_a_correction_is_itself_asked_about_where_everything_is():
    with Talk("always") as talk:
        talk.say("go to the kitchen", "no, the bedroom")
        assert talk.statuses == ["asked", "declined", "asked"]
        talk.say("yes")
        assert talk.body.sent == ["bedroom"]


def test_of_several_calls_the_one_that_drives_is_corrected_and_the_others_stay():
    with Talk("always") as talk:
        talk.say("go to the kitchen then where are you")
        talk.conversation.set_confirm("unsure")
        talk.say("no, the office")
        assert talk.body.sent == ["office"]
        assert [one.skill for one in talk.questions[0].calls] == ["navigate_to", "get_pose"]


def test_of_two_drives_nobody_knows_which_one_was_wrong():
    with Talk("always") as talk:
        talk.say("go to the kitchen then go to the bedroom")
        talk.conversation.set_confirm("unsure")
        talk.say("no, the office")
        assert talk.body.sent == []
        assert talk.answers[-1] == "All right, I leave it."


@pytest.mark.parametrize("said", ["no, 3 meters", "No, three meters!", "nope, 3 metres please"])
def test_a_number_is_corrected_like_a_place(said):
    with Talk("unsure") as talk:
        talk.say("walk 2 meters", said)
        assert talk.body.sent == [2.0, 3.0]


def test_a_corrected_value_that_cannot_be_is_refused_with_its_reason():
    with Talk("unsure") as talk:
        talk.say("walk 2 meters", "no, 12 meters")
        assert talk.body.sent == [2.0]
        assert talk.answers[-1] == "I could not do that: that is too far."


@pytest.mark.parametrize(
    "said",
    [
        "no, not the kitchen",
        "not the office",
        "no, never go to the office",
        "no, don't go to the office",
        "not the office but the kitchen",
        "no, she is in the office",
        "no, the office is closed today",
        "no, 2 people are in the office",
        "the office",
        "no, I do not want that",
    ],
)
@pytest.mark.parametrize("asked", [True, False], ids=["asked", "begun"])
def test_what_is_no_plain_correction_moves_nothing(said, asked):
    with Talk("always" if asked else "unsure") as talk:
        talk.say("go to the kitchen")
        sent = list(talk.body.sent)
        talk.conversation.set_confirm("unsure")
        talk.say(said)
        assert talk.body.sent == sent


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("es", "no vaya a la oficina"), ("es", "no, no a la oficina"),
        ("pt", "não vá para o escritório"), ("pl", "nie jedź do gabinetu"),
        ("pl", "nie do gabinetu"), ("ru", "не в кабинет"), ("de", "nein, nicht ins Büro"),
        ("fr", "non, pas au bureau"), ("it", "non andare in studio"),
        ("nl", "nee, niet naar het kantoor"), ("tr", "hayır, ofise değil"),
        ("ar", "لا تذهب إلى المكتب"), ("id", "jangan pergi ke kantor"), ("hi", "दफ़्तर नहीं"),
        ("vi", "không đi đến văn phòng"), ("zh", "不去书房"), ("zh", "不要去书房"),
        ("ja", "書斎じゃない"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("asked", [True, False], ids=["asked", "begun"])
def test_where_it_is_told_not_to_go_it_does_not_go(code, said, asked):
    with Talk("always" if asked else "unsure", language=code) as talk:
        talk.say(KITCHEN[code])
        talk.conversation.set_confirm("unsure")
        talk.say(said)
        assert "office" not in talk.body.sent


def test_a_plain_command_may_follow_a_no():
    with Talk("always") as talk:
        talk.say("go to the kitchen")
        talk.conversation.set_confirm("unsure")
        talk.say("no, walk 2 meters")
        assert talk.body.sent == [2.0]
        assert talk.statuses == ["asked", "declined"]


def test_an_unknown_place_after_a_no_is_refused_by_name():
    with Talk("always") as talk:
        talk.say("go to the kitchen", "no, go to the garage")
        assert talk.answers[-1].startswith("I do not know the room 'garage'.")
        assert talk.statuses == ["asked", "declined"]


def test_a_drive_that_ended_can_be_corrected_for_a_while_only():
    with Talk("unsure") as talk:
        talk.say("go to the kitchen")
        talk.clock.now_s += CORRECTED_S
        talk.say("no, the office")
        talk.clock.now_s += CORRECTED_S + 1
        talk.say("no, the bedroom")
        assert talk.body.sent == ["kitchen", "office"]


def test_a_reset_forgets_what_could_be_corrected():
    with Talk("unsure") as talk:
        talk.say("go to the kitchen")
        talk.conversation.submit(Reset())
        talk.say("no, the office")
        assert talk.body.sent == ["kitchen"]
