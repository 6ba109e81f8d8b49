"""Places that a robot is told the names of, and finds again after a restart.

Imports core, and of the agent skills, name_rules, same_name and reasons; knows nothing of any body.
"""
