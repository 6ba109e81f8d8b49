"""What a phrasebook says of how sentences are put together."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Hearing:
    """How sentences are put together.

    `joints` are words between two commands, `articles` stand before a name, `clause_words` never
    stand in one, `pair` is what is put between two bare numbers. `spaced` is False where words have
    no spaces between them. `written` are commands in the spelling that templates understand: an
    example for whoever writes down what is spoken. `reserved` is what people answer with, and what
    they say to any robot: no place or thing may be called so. `places` are what people call places,
    in templates: "this is the charger" names one, "this is the end" does not. Whoever ends in an
    `unfinished` word has not ended. `goes_on` are examples of what may follow on a command that is
    whole without: "turn left", "90 degrees".
    """

    joints: tuple[str, ...] = ()
    articles: tuple[str, ...] = ()
    clause_words: frozenset[str] = frozenset()
    pair: str = "and"
    spaced: bool = True
    written: str = ""
    reserved: tuple[str, ...] = ()
    places: tuple[str, ...] = ()
    unfinished: tuple[str, ...] = ()
    goes_on: tuple[str, ...] = ()
