"""How the pen is lowered and lifted."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from daemon.config.section import Positive, Section


class ZPenSettings(Section):
    """The pen hangs on the Z axis; up is +Z, only the paper's own machine has it at Z-5."""

    kind: Literal["z"] = "z"
    """The pen hangs on the Z axis."""
    up_mm: float = 5.0
    """Z where it is lifted."""
    down_mm: float = 0.0
    """Z where it draws."""
    plunge_mm_s: Positive = 10.0
    """How fast it is lowered."""

    def check_lifts(self) -> None:
        """Raises ValueError when up is not above down."""
        if self.up_mm <= self.down_mm:
            raise ValueError(f"pen.up_mm = {self.up_mm:g} must be above pen.down_mm = {self.down_mm:g}")


class ServoPenSettings(Section):
    """The pen hangs on a servo driven by the spindle output: `M3 S...`."""

    kind: Literal["servo"]
    """The pen hangs on a servo driven by the spindle output."""
    up_s: Annotated[float, Field(ge=0)] = 0.0
    """The S word that lifts the pen; a number for the controller, no time."""
    down_s: Annotated[float, Field(ge=0)] = 1000.0
    """The S word that lowers it."""
    dwell_s: Annotated[float, Field(ge=0, le=10)] = 0.2
    """Seconds the servo takes."""


def _kind_of(pen: Any) -> Any:
    return pen.get("kind", "z") if isinstance(pen, Mapping) else getattr(pen, "kind", None)


PenSettings: TypeAlias = Annotated[
    Annotated[ZPenSettings, Tag("z")] | Annotated[ServoPenSettings, Tag("servo")],
    Discriminator(
        _kind_of, custom_error_type="kind", custom_error_message="a pen has kind = 'z' or 'servo': write one of these"
    ),
]
"""By its kind; z where none is said."""
