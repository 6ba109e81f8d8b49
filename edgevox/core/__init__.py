"""The vocabulary of the house: events, commands, the bus, cancellation, settings, languages.

Imports nothing else of edgevox.
"""
