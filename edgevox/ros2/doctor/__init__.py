"""Checks of `edgevox doctor` and of the start-up, each run in its own process."""
