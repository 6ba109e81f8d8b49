"""Small programs: orders that are repeated, delayed, or wait for something to be so.

Sentences become frozen dataclasses (`program`) by templates alone, never by a language model; they
are bounded (`program_limits`), kept and run one after another on the goal runner (`keeper`,
`program_run`).
"""
