"""Servers on the network that a robot asks before its own models: for words, hearing and speech.

Here stands what all of them share: the address with its key, an exchange that a caller can always
leave, the errors, and the breaker that leaves a failed server alone. What is asked stands with
whoever asks: `edgevox.agent.llm.remote_model` and `edgevox.voice.remote`.
"""
