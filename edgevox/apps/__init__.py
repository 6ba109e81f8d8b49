"""Composition roots: each program puts its parts together here, by hand. Nothing imports apps."""
