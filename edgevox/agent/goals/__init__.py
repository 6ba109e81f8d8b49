"""Skills at work: goals, the lanes in which they run, and the executor."""
