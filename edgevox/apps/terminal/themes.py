"""The colours of the full-screen terminal: for dark and for light terminals, F4 changes.

Every text has a contrast of at least 4.5 to its background; Textual's light theme has less.
"""

from dataclasses import replace

from textual.theme import BUILTIN_THEMES

DARK, LIGHT = "textual-dark", "edgevox-light"
LIGHT_THEME = replace(
    BUILTIN_THEMES["textual-light"],
    name=LIGHT,
    background="#ffffff",
    surface="#f7f7f7",
    panel="#e3e6ea",
    variables={
        **BUILTIN_THEMES["textual-light"].variables,
        "text-primary": "#00508c",
        "text-success": "#0b6630",
        "text-warning": "#7a4a00",
        "text-error": "#a31212",
        "text-accent": "#6a2a8c",
        "text-muted": "#555555",
        "footer-key-foreground": "#00508c",
    },
)


def has_light_background(colours: str) -> bool:
    """Whether a terminal's `COLORFGBG` ("0;15") names a light background."""
    last = colours.rpartition(";")[2]
    return last.isdecimal() and int(last) not in (*range(7), 8)
