"""What made the weights that are ours; see README.md. EdgeVox runs and ships nothing of it."""
