"""The vocabulary: events, commands, the bus, cancellation, settings, languages.

Imports nothing else of edgevox.
"""
