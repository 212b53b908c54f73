"""The scanner: which one, how it scans, and which button of its is heard."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from daemon.config.section import Positive, Section

_OURS = (
    "accept-md5-only", "all-options", "batch", "buffer-size", "device-name", "dont-scan", "format",
    "formatted-device-list", "help", "icc-profile", "list-devices", "mode", "output-file", "progress", "resolution",
    "source", "test", "version",
)  # fmt: skip
"""scanimage takes an option by its beginning, so no beginning of these may be given."""


class Scanner(Section):
    kind: Literal["sane", "none"] = "sane"
    """"none": there is no scanner, whatever the rest of this section says."""
    device: str = ""
    """As `scanimage -L` names it; the only one where nothing is said."""
    resolution_dpi: Annotated[int, Field(ge=50, le=2400)] = 300
    """What the scanner is asked for; it may take another, which is read from the page."""
    mode: str = "Gray"
    """As the scanner calls it."""
    source: str = ""
    """As the scanner calls its glass or feeder; a feeder is emptied, each page is a picture."""
    size_mm: tuple[Positive, Positive] | None = None
    """How much of the glass is scanned, from the corner; all of it where nothing is said."""
    options: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9-]+$")], str | bool | int | float] = Field(
        default_factory=dict
    )
    """Further options of the scanner's driver, as `scanimage -A` lists them; true: one that takes no value."""
    page_within_s: Annotated[float, Field(ge=1, le=3600)] = 120.0
    """A page that takes longer is broken off."""
    button: str = ""
    """The name of the button that scans, as `scanimage -A` lists it."""
    button_every_s: Annotated[float, Field(ge=0.2, le=60)] = 1.0
    """So often the button is looked at."""

    @field_validator("options")
    @classmethod
    def _not_ours(cls, options: dict[str, str | bool | int | float]) -> dict[str, str | bool | int | float]:
        taken = [name for name in options for ours in _OURS if ours.startswith(name) or name.startswith("batch")]
        if taken:
            raise ValueError(f"'{taken[0]}' is not the driver's: set it by a key of [scanner], or leave it out")
        return options

    @property
    def driver_options(self) -> dict[str, str]:
        """By name, as scanimage takes them; "" is one without a value."""
        return {name: "" if value is True else str(value) for name, value in self.options.items()}
