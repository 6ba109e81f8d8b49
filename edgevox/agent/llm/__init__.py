"""Language models behind one interface, and the prompt and grammar that make their calls valid."""
