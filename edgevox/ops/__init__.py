"""Logs, metrics, health, diagnostics: what whoever runs a robot wants to know of it.

Imports core, nothing else of edgevox.
"""
