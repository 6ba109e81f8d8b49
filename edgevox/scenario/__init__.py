"""Scenario files: steps, and conditions with deadlines. docs/scenarios.md is for users.

`format` is the format; `judge` decides from what is seen and knows nothing of who
saw it; `run` plays in a `Harness` and tells a person. The harnesses are elsewhere: a conversation
with a body in apps, a robot on the wire in ros2. Imports core, nothing else of edgevox.
"""

from edgevox.scenario.format import Scenario, load_scenario
from edgevox.scenario.run import Harness, run_scenario

__all__ = ["Harness", "Scenario", "load_scenario", "run_scenario"]
