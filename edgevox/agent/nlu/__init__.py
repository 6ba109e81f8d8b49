"""Understanding of utterances: by templates, programs, a judged reading, or a language model.

`interpreter` asks them in this order. hassil matches `templates`. `order_reader` reads programs
(`orders`). `reading` finds the calls that a sentence could be, with `lexicon` and `clauses`;
`decider` judges the reading, by its evidence and the `encoder`, with the trained head of `meaning`.
Imports no engine but numpy.
"""
