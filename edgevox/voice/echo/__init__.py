"""The robot's own voice in the microphone: what was played, and how it is taken out."""
