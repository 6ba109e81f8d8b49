"""What is said and understood in each language, as data: one TOML file a language, by its code.

`en.toml` says what each entry is for. Skills carry their English themselves; a phrasebook holds
what they are in another language, and whatever it lacks stays English.
"""
