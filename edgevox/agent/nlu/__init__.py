"""What an utterance means: by templates, programs, a judged reading, or a language model.

`interpreter` asks them in this order. `templates` are matched by hassil. `readings` says what calls
a sentence could be, from what `lexicon`, `clauses` and `mentions` find in it; `decider` judges
that, by the numbers of `evidence` and `encoder`, which the trained head of `confidence` weighs.
Imports no engine but numpy.
"""
