"""A robot that is described by a file: its skills are made of the ROS 2 interfaces that it has.

Imports core, agent.skills, agent.text, agent.phrases, robots and ros2 of edgevox.
"""
