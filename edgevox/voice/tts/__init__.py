"""Text to speech: engines behind one interface, each imported in its own module only.

Imports core and edgevox.voice.audio.
"""
