"""Wake words and phrases."""
