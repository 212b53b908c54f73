"""The button beside the machine: where it is, and what it does."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from daemon.config.section import Section
from daemon.errors import unknown
from daemon.intake.keys import code_of

CHIP = "/dev/gpiochip0"


class Button(Section):
    kind: Literal["key", "gpio", "none"] = "key"
    """A key that types, a button at a pin of the board, or "none", whatever the rest of this section says."""
    does: Literal["next", "scan"] = "next"
    """Pressed, it says that a new sheet is in, or has the scanner scan."""
    machine: str = ""
    """Whose sheet it is, where there are several machines."""
    path: str = ""
    """Of the keyboard, as /dev/input/by-id/NAME-event-kbd; or of the pins' chip, "" is then /dev/gpiochip0."""
    key: int | str = "any"
    """Which key: its name, as "kpenter", "space" or "f1", its number, or "any"."""
    grab: bool = False
    """What is typed at this keyboard goes nowhere else: for one that serves as a button only."""
    line: int | str | None = None
    """The pin: the number of its line at the chip, or the line's name."""
    pull: Literal["up", "down", "none"] = "up"
    """"up": the button connects the pin with ground; "down": with the supply; "none": a resistor outside pulls up."""
    debounce_s: Annotated[float, Field(ge=0, le=1)] = 0.03
    """What a pin does for a shorter time is no press."""

    @field_validator("key")
    @classmethod
    def _known(cls, key: int | str) -> int | str:
        code_of(key)
        return key

    @model_validator(mode="after")
    def _is_somewhere(self) -> Button:
        if self.kind == "key" and not self.path.startswith("/"):
            raise ValueError(f"path = '{self.path}' is no keyboard: `ls /dev/input/by-id` lists those there are")
        if self.kind == "gpio" and self.line is None:
            raise ValueError("no line is set: say at which line of the chip the button is, `gpioinfo` lists them")
        return self

    @property
    def chip(self) -> str:
        """The file of the pins' chip."""
        return self.path or CHIP

    def check(self, machines: Sequence[str], *, scans: bool) -> None:
        """Raises ValueError where what it does cannot be done. scans: there is a scanner."""
        if self.kind == "none":
            return
        if self.does == "scan" and not scans:
            raise ValueError("[button] does = 'scan', but no scanner is set: add a section [scanner], or --scanner")
        if self.machine and self.machine not in machines:
            raise ValueError(unknown(f"[button] machine = '{self.machine}'", self.machine, machines))
        if self.does == "next" and not self.machine and len(machines) > 1:
            raise ValueError(f"[button] of which machine? say machine = one of {', '.join(machines)}")
