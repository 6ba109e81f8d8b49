"""Clients of a robot's own topics, services and actions, for skills: each wait has an end.

A skill's thread waits, the node's thread never does. Imports core, agent.skills, agent.own_phrases
and ros2 of edgevox.
"""
