"""Voices, noises and rooms made here, each with a half to train or tune with and one to test with.

What tests is never what trains: ten of Kokoro's voices, a third of espeak-ng's, whole kinds of
noise, the seeds of all others, and the rooms of the second half are held out. Sound is mono,
16 bit, 16 kHz.
"""

from enum import Enum


class Half(Enum):
    """Which half: the one to train and tune with, or the one that is held out for tests."""

    TRAIN = "train"
    HELD_OUT = "held-out"
