"""Bodies that skills move, each behind the same small protocols of `capabilities`.

Imports core, models, and of the agent what skills are made of (skills, reasons and
name_rules) and what it asks of a body (known). Each simulator's engine is imported
in its own module only.
"""
