"""What is said and heard in each language, and the names that a robot may have."""
