"""Scenario files: what is said when, and what must be true by when; docs/scenarios.md is for users.

`model`, `steps`, `conditions` and `comparisons` are the format; `judge` decides from what is seen
and knows nothing of who saw it; `run` plays on a `stage`, a conversation with a body; `report`
tells a person.
"""

from edgevox.apps.scenario.model import Scenario
from edgevox.apps.scenario.reading import load_scenario
from edgevox.apps.scenario.run import run_scenario
from edgevox.apps.scenario.stage import Stage

__all__ = ["Scenario", "Stage", "load_scenario", "run_scenario"]
