"""What trains the stop word spotter: its texts, the clips that are made of them, the network."""
