"""The conversation with a person: questions, yes and no, references, what was done."""
