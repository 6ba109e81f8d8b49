"""Logs, metrics, health and diagnostics for the operators of a robot.

Imports core, nothing else of edgevox.
"""
