"""The robot's own voice, taken out of what a microphone hears; the echo is simulated."""

import numpy as np
import pytest
from simulated_echo import decibels, room, samples, through, voice

from edgevox.core.settings import Settings
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, rms
from edgevox.voice.echo.canceller import TAIL_S, EchoCanceller, open_echo
from edgevox.voice.echo.gate import EchoGate, EchoLoss
from edgevox.voice.echo.played import PlayedSound

LEARNT = 150
"""Frames after which all have learnt the way: 4.8 s."""
LEVEL = 0.1


def opened(echo="cancel", **more):
    reference = PlayedSound()
    return open_echo(echo, lambda: LEVEL, reference, **more), reference


def quiet(count):
    """What a microphone gives that hears nothing of it."""
    return np.random.default_rng(4).normal(0, 0.0005, count)


def joined(sounds):
    return np.concatenate(sounds)


@pytest.fixture(scope="module")
def played():
    return voice(12.0, seed=1, level=LEVEL)


@pytest.mark.parametrize(
    "delay_s", [0.1, *(pytest.param(one, marks=pytest.mark.long) for one in (0.02, 0.25))]
)
def test_the_robots_own_voice_is_taken_out_whatever_the_delay(played, delay_s):
    heard = room(played, delay_s=delay_s)
    echo, reference = opened()

    given = list(through(echo, played, heard, reference))[LEARNT:]

    came = samples(heard)[LEARNT * FRAME_SAMPLES :]
    assert decibels(came, joined([one.voice for one in given])) > 20.0
    assert decibels(came, joined([one.words for one in given])) > 10.0
    assert not any(one.somebody for one in given)
    assert echo.loss.enough


def test_frames_that_come_late_each_by_another_while_are_cleaned_as_well(played):
    heard, rng = room(played), np.random.default_rng(5)
    echo, reference = opened()

    given = list(through(echo, played, heard, reference, late_s=lambda: rng.uniform(0, 0.03)))

    came = samples(heard)[LEARNT * FRAME_SAMPLES :]
    assert decibels(came, joined([one.voice for one in given[LEARNT:]])) > 15.0


def test_a_person_quieter_than_the_loudspeaker_is_left_and_the_gate_alone_would_drop_them(played):
    heard, at = room(played), 8 * RATE_HZ
    person = voice(1.0, seed=9, level=10 ** (-5 / 20) * LEVEL / 2)
    heard[at : at + person.size] += person
    frames = slice(at // FRAME_SAMPLES + 1, at // FRAME_SAMPLES + 30)

    def loud(echo, reference):
        """How many frames of the person's a detector of voices is given."""
        given = list(through(echo, played, heard, reference))
        return given, sum(rms(one.voice) > 0.004 for one in given[frames])

    gated, passed = loud(*opened("gate"))
    cleaned, left = loud(*opened("cancel"))

    assert left > passed
    said = samples(heard - room(played))[frames.start * FRAME_SAMPLES : frames.stop * FRAME_SAMPLES]
    error = joined([one.words for one in cleaned[frames]]).astype(int) - said
    lost = joined([one.words for one in gated[frames]]).astype(int) - said
    assert decibels(said, error) > 3.0
    assert decibels(said, error) > decibels(said, lost) + 3.0


class Suppressor:
    """Leaves a share of all that it hears: nearly none of an echo."""

    def __init__(self):
        self.leaves = 0.01

    def process(self, near, far):
        return (self.leaves * near).astype(np.int16)


@pytest.mark.parametrize(
    ("leaves", "given_on"), [(0.5, "words"), (0.05, "voice")], ids=["a person", "its own voice"]
)
def test_what_is_louder_than_the_filter_leaves_is_a_person_unless_it_is_suppressed(
    played, leaves, given_on
):
    heard, at = room(played), 8 * RATE_HZ
    loud = voice(1.0, seed=9, level=LEVEL)
    heard[at : at + loud.size] += loud
    engine = Suppressor()
    echo, reference = opened(engine=lambda: engine)
    begins, few = at // FRAME_SAMPLES + 1, []

    for number, one in enumerate(through(echo, played, heard, reference)):
        if number == begins:
            engine.leaves = leaves
        if begins < number < begins + 20:
            few.append(one)

    assert echo.loss.enough
    assert {one.somebody for one in few[5:]} == {given_on == "words"}
    found = [rms(one.voice) / rms(one.words) for one in few]
    assert np.median(found) == pytest.approx(1.0 if given_on == "words" else leaves, rel=0.3)


def test_where_the_reference_is_not_what_is_played_the_gate_decides(played):
    heard, other = room(played), voice(12.0, seed=77, level=LEVEL)
    echo, reference = opened()

    given = list(through(echo, other, heard, reference))

    assert not echo.loss.enough
    assert not any(one.voice.any() for one in given[LEARNT:])


def test_before_it_is_measured_the_gate_decides(played):
    echo, reference = opened()

    first = next(through(echo, played, room(played, delay_s=0.0), reference))

    assert not echo.loss.enough
    assert not first.voice.any()


def test_while_nothing_is_played_a_frame_is_given_on_as_it_came(played):
    reference = PlayedSound()
    echo = open_echo("cancel", lambda: 0.0, reference)
    heard = samples(played)

    given = list(through(echo, played, played, reference, told=False))

    assert np.array_equal(joined([one.words for one in given]), heard[: len(given) * FRAME_SAMPLES])


def test_without_the_package_the_gate_is_used_and_the_log_says_so(caplog):
    def missing():
        raise ImportError("no module named 'pywebrtc_audio'")

    echo, _ = opened(engine=missing)

    assert isinstance(echo, EchoGate)
    assert "echo_canceller_missing" in caplog.text


def test_the_gate_is_used_where_nobody_knows_what_is_played():
    assert isinstance(open_echo("cancel", lambda: LEVEL, None), EchoGate)


def test_the_canceller_is_used_where_it_is_asked_for():
    assert isinstance(opened()[0], EchoCanceller)


def test_it_is_what_a_robot_does_unless_told_otherwise():
    assert Settings.model_fields["echo"].default == "cancel"


def test_with_a_headset_a_person_is_heard_as_through_the_gate_alone(played):
    heard, at = quiet(played.size), 4 * RATE_HZ
    person = voice(6.0, seed=9, level=LEVEL)
    heard[at : at + person.size] += person
    echo, reference = opened()
    gate = EchoGate(lambda: LEVEL, tail_s=TAIL_S)

    given = list(through(echo, played, heard, reference))

    gated = list(through(gate, played, heard, PlayedSound(), told=False))
    assert np.array_equal(joined([one.voice for one in given]), joined([o.voice for o in gated]))
    assert joined([one.voice for one in given]).any()
    assert not echo.loss.enough


@pytest.mark.parametrize("level", [LEVEL, 0.0])
def test_where_nothing_is_told_of_what_is_played_the_gate_decides_as_ever(played, level):
    """A file as sound, no loudspeaker, or a simulated one: nobody knows what comes back."""
    heard = samples(room(played))
    echo, gate = open_echo("cancel", lambda: level, PlayedSound()), EchoGate(lambda: level)

    given = list(through(echo, played, room(played), PlayedSound(), told=False))

    gated = list(through(gate, played, room(played), PlayedSound(), told=False))
    assert np.array_equal(joined([one.voice for one in given]), joined([o.voice for o in gated]))
    assert np.array_equal(joined([one.clean for one in given]), heard[: len(given) * FRAME_SAMPLES])


@pytest.mark.parametrize(
    ("left", "filtered"),
    [(0.5, 0.5), (0.0, 1.0)],
    ids=["it weakens the echo no longer", "it drops what is no echo"],
)
def test_one_that_only_fell_silent_at_first_is_not_believed(left, filtered):
    loss, heard = EchoLoss(), np.full(FRAME_SAMPLES, 3000, np.int16)
    for _ in range(28):
        loss.push(heard, heard // 100, heard, heard)

    for _ in range(60):
        loss.push(heard, (heard * left).astype(np.int16), (heard * filtered).astype(int), heard)

    assert not loss.enough
