"""A word that a network finds in several windows is one word."""

from edgevox.voice.audio import FRAME_S
from edgevox.voice.word_detection import OncePerWord

REST = 3
"""Frames after a word in which none counts."""


def counted(once, found):
    return [number for number, one in enumerate(found) if once.counts(one)]


def test_a_word_that_lasts_for_several_frames_counts_once():
    assert counted(OncePerWord(REST * FRAME_S), [False, True, True, True, False]) == [1]


def test_a_word_said_again_after_the_rest_counts_again():
    found = [True, *[False] * REST, True, *[False] * REST, True]

    assert counted(OncePerWord(REST * FRAME_S), found) == [0, 1 + REST, 2 + 2 * REST]


def test_what_does_not_follow_on_a_word_does_not_wait_for_it():
    once = OncePerWord(REST * FRAME_S)
    assert once.counts(True)

    once.forget()

    assert once.counts(True)
