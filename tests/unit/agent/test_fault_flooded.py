"""What waits for the conversation is bounded, whoever floods it with whatever."""

from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.inbox import MAX_WAITING, Announce, Forget, Inbox, Settle, SwitchLanguage
from edgevox.core.commands import Heard, RunSkill, Speak, TextInput
from edgevox.core.errors import Refusal
from edgevox.core.files.text import MAX_CHARACTERS

ASKED = [TextInput("go"), Heard("go", 0.0), Speak("hello"), RunSkill("stop", {})]


def all_of(waiting):
    found = []
    while not waiting.idle:
        found.append(waiting.take())
        waiting.done()
    return found


def test_what_was_asked_is_taken_in_its_order_up_to_the_limit():
    waiting = Inbox()
    kept = [waiting.put(TextInput(str(number))) for number in range(MAX_WAITING + 10)]
    assert kept == [None] * MAX_WAITING + [Refusal.TOO_MANY] * 10
    assert [one.text for one in all_of(waiting)] == [str(n) for n in range(MAX_WAITING)]


def test_of_a_text_of_megabytes_only_its_beginning_waits_and_its_length():
    waiting = Inbox()
    for words in (TextInput, Speak):
        assert waiting.put(words("x" * 5_000_000)) is Refusal.TOO_LONG
        kept = waiting.take()
        assert (kept.length, kept.asked) == (5_000_000, words is TextInput)
        assert kept.beginning == "x" * MAX_CHARACTERS
    assert waiting.refusals == {"too_long": 2, "too_many": 0}


def test_it_is_said_of_one_too_many_and_too_long_that_too_many_wait():
    waiting = Inbox()
    for _ in range(MAX_WAITING):
        waiting.put(TextInput("go"))
    assert waiting.put(Speak("x" * 5_000_000)) is Refusal.TOO_MANY
    assert waiting.put(Announce("Stopped.")) is None
    assert waiting.refusals == {"too_long": 0, "too_many": 1}


def test_of_languages_on_end_the_last_one_counts_and_each_sentence_keeps_its_own():
    waiting = Inbox()
    for item in (
        SwitchLanguage("fr"),
        SwitchLanguage("de"),
        TextInput("los"),
        SwitchLanguage("en"),
        SwitchLanguage("fr"),
    ):
        waiting.put(item)
    assert all_of(waiting) == [SwitchLanguage("de"), TextInput("los"), SwitchLanguage("fr")]


def test_a_stop_forgets_what_was_asked_and_not_what_was_set():
    waiting = Inbox()
    for item in (
        SwitchLanguage("fr"),
        TextInput("go"),
        Forget(),
        Announce("x"),
        SwitchLanguage("de"),
    ):
        waiting.put(item)
    waiting.stop()
    assert sorted(all_of(waiting), key=repr) == [Forget(), SwitchLanguage("de")]


_STEPS = st.lists(
    st.sampled_from(
        [*ASKED, SwitchLanguage("en"), SwitchLanguage("fr"), Forget(), Settle(), "stop"]
    ),
    max_size=400,
)


@given(_STEPS)
def test_nothing_that_comes_from_outside_makes_it_long(steps):
    """A reset and an interrupt stop before they are put, as the conversation does it."""
    waiting = Inbox()
    for step in steps:
        if step == "stop" or isinstance(step, Forget | Settle):
            waiting.stop()
        if step != "stop":
            waiting.put(step)
    assert len(all_of(waiting)) <= 2 * MAX_WAITING + 4
