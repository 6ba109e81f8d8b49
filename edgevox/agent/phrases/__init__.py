"""What is said and understood in each language, as data: one TOML file a language, by its code.

`en.toml` says what each entry is for, and holds all that is answered in English. Only what people
say to have something done stands beside the skills in English; a phrasebook of another language
holds that, too, and what it lacks stays English.
"""
