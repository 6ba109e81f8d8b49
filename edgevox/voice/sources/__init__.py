"""Where sound comes from: a sound card, WAV files, somebody who pushes it, or nowhere.

Each is an `AudioSource` of `edgevox.voice.audio`; `open_source` chooses one by its name.
"""
