"""Language models behind one interface, their prompt, and the grammar of their answers."""
