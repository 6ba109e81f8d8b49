"""What words tell of whether somebody who fell silent has ended."""

from enum import StrEnum


class Ending(StrEnum):
    """How what was said so far ends.

    `FINAL`: nothing that follows could change it, a stop. `WHOLE`: a plain command. `MAY_GO_ON`: a
    plain command that often has more words, as "turn left". `OPEN`: anything else. `BROKEN_OFF`: it
    ends in a word that more must follow, as "go to the".
    """

    FINAL = "final"
    WHOLE = "whole"
    MAY_GO_ON = "may_go_on"
    OPEN = "open"
    BROKEN_OFF = "broken_off"
