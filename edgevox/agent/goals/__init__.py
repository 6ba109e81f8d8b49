"""Skills at work: goals, the lanes that they run in, and what executes them."""
