"""Where the figures come from: `core` runs, keeps and renders, the other folders measure.

    python -m benchmarks.core.run --help

Benchmarks use the rigs of the tests, and so measure as these do: after this, they can be imported.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
"""The repository: programs that are started as `python -m benchmarks...` start here."""
_RIGS = [str(ROOT / "tests" / name) for name in ("", "models", "ros2", "compose", "browser")]

sys.path[:0] = [folder for folder in _RIGS if folder not in sys.path]
