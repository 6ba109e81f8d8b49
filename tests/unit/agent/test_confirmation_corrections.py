"""A room is corrected in every form that a language has for it; the rest is in `tests/talk`."""

import pytest
from few_languages import few
from support.conversation import Talk

from edgevox.agent.phrases.load import phrasebook
from edgevox.core.languages import LANGUAGES


@pytest.mark.parametrize("code", few(LANGUAGES))
def test_every_room_is_understood_in_every_form_that_its_phrasebook_has(code):
    book = phrasebook(code)
    forms = [("office", form) for form in _forms(book, "office")]
    forms += [("bedroom", form) for form in _forms(book, "bedroom")]
    no = book.answers.no[0]
    with Talk(language=code) as talk:
        for room, form in forms:
            talk.conversation.set_confirm("always")
            talk.say("go to the kitchen")
            talk.conversation.set_confirm("unsure")
            talk.say(f"{no}, {form}")
            assert talk.body.sent[-1:] == [room], form


def _forms(book, room):
    word = book.word(room)
    return {word.name, word.to, *word.heard} if book.fallback else {f"the {room}", f"to the {room}"}
