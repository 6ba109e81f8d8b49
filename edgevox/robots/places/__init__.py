"""Places that a robot is told the names of, and finds again after a restart.

Imports core, agent.skills, agent.names and agent.reasons; knows nothing of any body.
"""
