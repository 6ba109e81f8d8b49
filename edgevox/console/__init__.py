"""The console: a page that the robot serves by itself, to talk to it, see it and stop it.

A face like any other: it subscribes to the bus and submits commands. What it shows and steers is
given by a `ConsoleContext`. Imports core, nothing else of edgevox.
"""
