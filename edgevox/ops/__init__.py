"""What whoever runs a robot wants to know of the machine it runs on.

Imports core, nothing else of edgevox.
"""
