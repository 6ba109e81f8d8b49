"""The sentence encoder, its vocabulary and the file of its weights."""
