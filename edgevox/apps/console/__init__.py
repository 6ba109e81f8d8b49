"""The console of an agent: the data that its page shows, and the requests that it allows.

It serves `edgevox.console`, which knows neither robots nor conversations.
"""
