"""The state of a random number generator as text, so that a training goes on as if never cut."""

import json

import numpy as np


def state_of(rng: np.random.Generator) -> str:
    """What `resume` takes."""
    return json.dumps(rng.bit_generator.state)


def resume(rng: np.random.Generator, state: str) -> None:
    """Draw on from there."""
    rng.bit_generator.state = json.loads(state)
