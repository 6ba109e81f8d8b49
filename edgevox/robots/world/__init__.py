"""The file that describes a flat world."""
