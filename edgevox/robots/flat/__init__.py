"""Robots on wheels in a flat world: engines, planner, pictures."""
