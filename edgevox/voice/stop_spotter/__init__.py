"""Stop words by their sound, while they are said; `edgevox.agent.stop` finds those of a text."""
