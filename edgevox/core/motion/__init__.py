"""Permission to move and ways to stop: interlock, software stop, drain, deadlines."""
