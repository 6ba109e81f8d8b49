"""Scenario files: what is said when, and what must be true by when. docs/scenarios.md is for users.

`model`, `steps`, `conditions` and `comparisons` are the format; `judge` decides from what is seen
and knows nothing of who saw it; `run` plays on a `stage`; `report` tells a person. The stages
themselves are elsewhere: a conversation with a body in apps, a robot on the wire in ros2.
Imports core, nothing else of edgevox.
"""

from edgevox.scenario.model import Scenario
from edgevox.scenario.reading import load_scenario
from edgevox.scenario.run import run_scenario
from edgevox.scenario.stage import Stage

__all__ = ["Scenario", "Stage", "load_scenario", "run_scenario"]
