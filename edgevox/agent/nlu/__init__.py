"""What an utterance may mean when no template knows it. Imports no engine but numpy."""
