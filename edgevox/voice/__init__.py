"""Sound to words, words to sound: sources, wake word, speech to text; text to speech, sinks.

The only package that touches sound cards. Imports core, nothing else of edgevox. Each engine is
imported in its own module only.
"""
