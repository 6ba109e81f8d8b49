"""What a language model is told and what it may answer: prompt, grammar, calls, history."""
