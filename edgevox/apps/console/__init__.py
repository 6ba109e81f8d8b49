"""Puts the console together: what its page is shown of an agent and its robot, and may ask of it.

It gives `edgevox.console` what that needs, which knows neither robots nor conversations.
"""
