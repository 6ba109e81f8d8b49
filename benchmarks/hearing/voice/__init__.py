"""Speaking with the robot: turns, barging in, spoken stops, an hour of sound, the parts alone."""
