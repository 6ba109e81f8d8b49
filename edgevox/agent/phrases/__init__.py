"""Sentences said and heard in each language, and the rules for a robot's names."""
