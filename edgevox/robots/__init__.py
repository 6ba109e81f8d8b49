"""Bodies that skills move, each behind the same small protocols of `capabilities`.

Imports core and agent.skills, nothing else of edgevox. Each simulator's engine is imported in its
own module only.
"""
