"""Speech that was misheard: rival transcripts, sounds, near commands, prompts."""
