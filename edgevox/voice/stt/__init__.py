"""Speech to text: what an engine must offer (`speech_to_text`), and faster-whisper (`whisper`)."""
