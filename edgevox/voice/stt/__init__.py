"""Speech to text: what an engine must offer (`base`), and faster-whisper (`whisper`)."""
