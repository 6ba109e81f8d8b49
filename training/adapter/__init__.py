"""What trains the adapter with which Whisper hears through noise: its texts, clips, network."""
