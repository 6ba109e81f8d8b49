"""Words to words and deeds: conversation, intents, language models, skills, safety.

Imports core, nothing else of edgevox.
"""
