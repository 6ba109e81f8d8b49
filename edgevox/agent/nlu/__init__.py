"""Understanding of utterances: by templates, programs, a judged reading, or a language model.

`interpreter` asks them in this order. hassil matches `templates`. `order_reader` reads programs.
`reading` finds the calls that a sentence could be, with `lexicon` and `clauses`; `decider` judges
the reading, by its evidence and the `encoder` with its trained head. What comes out is a `meaning`.
Imports no engine but numpy.
"""
