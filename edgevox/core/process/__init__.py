"""The process itself: its limits, its output, the extras that are installed."""
