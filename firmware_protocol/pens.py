"""Where a program waits for another pen."""

from __future__ import annotations

PEN_CHANGE = "M0"
"""The line before which everything is drawn and the machine is parked: a program stop, as controls of all kinds read
it. What stands behind the word is a comment."""


def is_pen_change(text: str) -> bool:
    """Whether a line of a program is one before which the pen is changed; other programs write it M00, too."""
    return text.split(" ", 1)[0] in {PEN_CHANGE, "M00"}
