"""What the agent does with words: its answers, its time, its memory, its language model."""
