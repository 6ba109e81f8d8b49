"""A child process that runs one probe, which may hang or die: ``child.py module:function``.

The probe's arguments follow on the command line. Its facts are the last line on standard output;
output of libraries goes to standard error.
"""

import importlib
import json
import os
import sys


def main(address: str, *arguments: str) -> None:
    """Probe, and print what was seen."""
    answers = os.dup(1)
    os.dup2(2, 1)
    module, _, function = address.partition(":")
    facts = getattr(importlib.import_module(module), function)(*arguments)
    os.write(answers, json.dumps(facts).encode() + b"\n")
    os.close(answers)


if __name__ == "__main__":
    main(*sys.argv[1:])
