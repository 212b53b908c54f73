"""The sizes of sheets by their names."""

from __future__ import annotations

from contextlib import suppress

from daemon.errors import SettingsError

PAPERS_MM = {
    "A3": (297.0, 420.0), "A4": (210.0, 297.0), "A5": (148.0, 210.0), "A6": (105.0, 148.0),
    "letter": (215.9, 279.4), "legal": (215.9, 355.6),
}  # fmt: skip
"""Width and height, upright (ISO 216, ANSI/ASME Y14.1)."""


def paper_mm(words: str) -> tuple[float, float]:
    """Of a name, also "A4 landscape", or of "210x297". Raises SettingsError."""
    name, _, way = words.strip().partition(" ")
    sizes = {known.lower(): size for known, size in PAPERS_MM.items()}
    with suppress(ValueError):
        width, height = sizes.get(name.lower()) or map(float, name.lower().split("x"))
        if min(width, height) > 0 and way in ("", "upright", "landscape"):
            return (height, width) if way == "landscape" else (width, height)
    raise SettingsError(
        f"'{words}' is no size of a sheet: say {', '.join(PAPERS_MM)}, with 'landscape' behind it where it lies so, "
        "or width x height in mm, as 210x297"
    )
