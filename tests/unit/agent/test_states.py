from hypothesis import given
from hypothesis import strategies as st

from edgevox.agent.turn import TRANSITIONS, StateMachine, Turn
from edgevox.core.bus import Bus
from edgevox.core.clock import SystemClock
from edgevox.core.events import State, StateChanged


class Watched:
    """A state machine and all it published."""

    def __init__(self):
        self.bus, self.seen = Bus(), []
        self.bus.subscribe(StateChanged, lambda event: self.seen.append(event.state))
        self.machine = StateMachine(self.bus)
        self.machine.start()

    def turn(self):
        return Turn(1, self.bus, SystemClock(), on_speech=lambda: None)


STEPS = st.one_of(
    st.tuples(st.just("enter"), st.sampled_from(State)),
    st.tuples(st.sampled_from(["rest", "transcribing"]), st.none()),
    st.tuples(st.just("transcribed"), st.booleans()),
)


@given(st.lists(STEPS, max_size=40))
def test_only_written_transitions_are_ever_published(steps):
    watched = Watched()
    for name, value in steps:
        match name:
            case "enter":
                watched.machine.enter(value)
            case "rest":
                watched.machine.rest()
            case "transcribing":
                watched.machine.transcribing()
            case "transcribed":
                watched.machine.transcribed(words=value)
    assert watched.seen[0] is State.LISTENING
    for before, after in zip(watched.seen, watched.seen[1:], strict=False):
        assert after in TRANSITIONS[before]
    assert watched.seen[-1] is watched.machine.state


def test_every_state_can_get_back_to_listening():
    for state in set(State) - {State.LISTENING}:
        assert State.LISTENING in TRANSITIONS[state]


def test_every_state_but_itself_can_be_interrupted():
    for state in set(State) - {State.INTERRUPTED}:
        assert State.INTERRUPTED in TRANSITIONS[state]


def test_a_cut_turn_changes_nothing_any_more_but_says_that_it_is_cut():
    watched = Watched()
    turn = watched.turn()
    watched.machine.enter(State.THINKING, turn)
    turn.token.cancel("enough")
    assert not watched.machine.enter(State.SPEAKING, turn)
    assert watched.machine.enter(State.INTERRUPTED, turn)
    assert watched.seen == [State.LISTENING, State.THINKING, State.INTERRUPTED]


def test_speech_during_an_answer_shows_when_the_answer_is_over():
    watched = Watched()
    watched.machine.enter(State.SPEAKING)
    watched.machine.transcribing()
    assert watched.machine.state is State.SPEAKING
    watched.machine.rest()
    assert watched.machine.state is State.TRANSCRIBING


def test_sound_without_words_leads_back_to_listening():
    watched = Watched()
    watched.machine.transcribing()
    watched.machine.transcribed(words=False)
    assert watched.seen == [State.LISTENING, State.TRANSCRIBING, State.LISTENING]


def test_the_second_of_two_utterances_keeps_it_transcribing():
    watched = Watched()
    watched.machine.transcribing()
    watched.machine.transcribing()
    watched.machine.transcribed(words=False)
    assert watched.machine.state is State.TRANSCRIBING
