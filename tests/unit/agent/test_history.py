from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.llm.prompt import CUT_MARK, History, size_tokens


def count(text):
    return len(text)


def test_exchanges_come_back_in_order():
    history = History(count, 1000)
    history.add("hi", "hello")
    history.add("how are you", "fine")
    assert [m.content for m in history.messages()] == ["hi", "hello", "how are you", "fine"]
    assert [m.role for m in history.messages()] == ["user", "assistant"] * 2


def test_a_cut_answer_is_marked():
    history = History(count, 1000)
    history.add("tell me a story", "Once", cut=True)
    assert history.messages()[-1].content == "Once" + CUT_MARK


def test_the_oldest_half_is_forgotten_at_once():
    history = History(count, 120)
    for number in range(5):
        history.add(f"question {number}", "answer")
    assert history.messages()[0].content != "question 0"
    assert history.messages()[-2].content == "question 4"


def test_nothing_is_left_after_clear():
    history = History(count, 1000)
    history.add("hi", "hello")
    history.clear()
    assert history.messages() == []


@given(st.lists(st.tuples(st.text(max_size=40), st.text(max_size=40)), max_size=30))
def test_history_never_outgrows_its_budget(exchanges):
    history = History(count, 200)
    for said, answered in exchanges:
        history.add(said, answered)
        assert size_tokens(count, history.messages()) <= 200
