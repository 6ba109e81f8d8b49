"""Stop words in text, how they may be spelt, and what a stop does (`stopping`).

Stop words are also found by their sound: `edgevox.voice.stop_spotter`.
"""
