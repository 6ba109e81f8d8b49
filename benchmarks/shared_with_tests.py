"""After this, what tests share can be imported: benchmarks use their rigs, measure as they do."""

import sys
from pathlib import Path

_TESTS = Path(__file__).resolve().parents[1] / "tests"

sys.path[:0] = [str(_TESTS / folder) for folder in ("", "models", "ros2", "compose", "browser")]
