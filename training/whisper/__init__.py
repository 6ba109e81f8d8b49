"""What the trainings of the stop word spotter and of the hearing adapter share."""
