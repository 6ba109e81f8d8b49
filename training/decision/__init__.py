"""What trains the sentence encoder's adapter and the head of the decider.

It learns from the corpus of the tests, among others.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))
