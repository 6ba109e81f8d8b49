"""Sound to words and back: commands, stop words, wake words, in quiet, in noise, over an echo."""
