"""Sources of sound: a sound card, WAV files, a program that pushes it, or none.

Each is an `AudioSource` of `edgevox.voice.audio`; `open_source` chooses one by its name.
"""
