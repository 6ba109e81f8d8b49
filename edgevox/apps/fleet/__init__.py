"""Many robots on one page: how each is, by its health, and where its console is. Read only.

It holds no session of any robot, so that it cannot command one. It may import what `apps` may.
"""
