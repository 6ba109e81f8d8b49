"""Words to calls to goals: conversation, intents, language models, skills, safety.

Imports core, nothing else of edgevox.
"""
