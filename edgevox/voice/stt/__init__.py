"""Speech to text: what an engine must offer, and faster-whisper as one."""
