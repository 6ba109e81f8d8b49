"""Stop words by their sound: what the spotter misses, what it takes for one, how soon."""
