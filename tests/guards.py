"""How long a test waits for what should come, on whatever machine."""

HUNG_S = 600.0
"""Only something that hangs takes so long."""
