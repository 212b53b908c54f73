"""Pens of several colours."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from daemon.colours import rgb_of
from daemon.config.section import Section


def _colour(text: str) -> str:
    rgb = rgb_of(text)
    if rgb is None:
        raise ValueError(f'\'{text}\' is no colour: write it as "#d03030", or by a name such as "red"')
    return f"#{bytes(rgb).hex()}"


class Pens(Section):
    """Without any, everything is drawn with one pen, by darkness alone."""

    colours: dict[Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,32}$")], Annotated[str, AfterValidator(_colour)]] = (
        Field(default_factory=dict)
    )
    """Pens by name with the colour of their lines, in the order in which they are put in: { black = "#1a1a1a", red =
    "#d03030" }. Each line is drawn with the pen whose colour it is nearest to; between two pens the machine parks and
    waits for `linedrawd resume`."""
    skip: tuple[str, ...] = ()
    """Names of pens whose lines are told apart and not drawn."""

    @model_validator(mode="after")
    def _known(self) -> Pens:
        if strange := [name for name in self.skip if name not in self.colours]:
            raise ValueError(f"skip = '{strange[0]}' is none of the colours: name it there, or leave it out")
        return self
