"""Speech to text: the interface of an engine, and faster-whisper as one."""
