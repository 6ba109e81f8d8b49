"""Voices, sentences, noises and rooms: a part to train with, one to tune with, one to test with.

What tests is never what trains, nor what chooses a threshold: ten of Kokoro's voices, a third of
espeak-ng's, whole kinds of noise, the seeds of all others, the rooms and the sentences of the part
`HELD_OUT` are for tests alone. Sound is mono, 16 bit, 16 kHz.
"""

from enum import Enum


class Half(Enum):
    """Which part: to train with, to choose a threshold with, or held out for tests.

    What tunes is taken from the half that is not held out.
    """

    TRAIN = "train"
    TUNING = "tuning"
    HELD_OUT = "held-out"
