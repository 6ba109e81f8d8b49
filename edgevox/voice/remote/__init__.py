"""Hearing and speech on a server, by the OpenAI audio API or Wyoming, with fallbacks on board.

Stop words never depend on it: their spotter, and the transcription of what is short or not for the
robot, are always on board.

`offered` is the other way round: a server of Wyoming, for Home Assistant.
"""
