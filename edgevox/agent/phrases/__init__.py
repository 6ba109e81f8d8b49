"""Sentences said and heard in each language, which `core/languages/*.toml` has, and a robot's names."""
