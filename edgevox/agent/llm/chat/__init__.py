"""Input and output of a language model: prompt, grammar, calls, history."""
