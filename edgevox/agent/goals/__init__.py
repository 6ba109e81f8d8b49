"""Skills at work: goals, the lanes that run and cancel them, and the executor that begins them."""
