"""Stop words by their sound."""
