"""Words to calls to goals: conversation, meaning, programs, policy, models, skills, safety.

Imports core, nothing else of edgevox.
"""
