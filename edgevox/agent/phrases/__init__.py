"""Sentences said and heard in each language (`core/languages/*.toml`), and names of robots."""
