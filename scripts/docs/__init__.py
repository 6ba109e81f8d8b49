"""The generated tables of the docs, each from where its facts are declared; `TABLES` has them all.

`told.toml` has the words that no code has: examples, and what a name stands for.
"""

from collections.abc import Callable, Mapping
from functools import partial

from docs import bodies, bounds, operating, ros2, talking, weights

TABLES: Mapping[str, Callable[[], str]] = {
    make.__name__: make
    for make in (
        bodies.states,
        bounds.bounds,
        operating.checks,
        operating.components,
        operating.environment,
        operating.logs,
        operating.metrics,
        ros2.agent_events,
        ros2.external,
        ros2.interop,
        ros2.more,
        ros2.parameters,
        ros2.published,
        ros2.qos,
        ros2.queries,
        ros2.subscribed,
        talking.endings,
        talking.languages,
        talking.turn,
        talking.wake_words,
        weights.not_commercial,
        weights.sets,
    )
} | {f"skills_{robot}": partial(bodies.skills, robot) for robot in bodies.SKILLS}
"""By the name that stands where each belongs on a page; those of a robot end in its name."""
