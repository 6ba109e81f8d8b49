"""Logs, metrics, health, diagnostics: what whoever runs a robot wants to know of it, by night too.

Imports core, nothing else of edgevox.
"""
