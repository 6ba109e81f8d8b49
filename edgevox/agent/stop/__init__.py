"""The words that stop a robot, and how they may be spelt."""
