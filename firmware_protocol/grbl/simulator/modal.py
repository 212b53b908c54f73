"""What GRBL 1.1 remembers between lines: modal state, and the places in the chip's memory."""

from __future__ import annotations

from dataclasses import dataclass, field

from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.settings import Settings, differing, fixed, float_bytes

HERE: Vector = (0.0, 0.0, 0.0)
G28, G30 = 6, 7
"""Their places behind G54 to G59."""
MM_PER_INCH = 25.4


@dataclass(slots=True)
class Memory:
    """The EEPROM: outlives every reset and loss of power."""

    settings: Settings
    places: list[Vector] = field(default_factory=lambda: [HERE] * 8)
    startup: list[str] = field(default_factory=lambda: ["", ""])
    build: str = ""

    def place(self, index: int, position_mm: Vector) -> int:
        """Write G54 to G59, G28 or G30. Returns how many bytes change."""
        changed = differing(float_bytes(self.places[index]), float_bytes(position_mm))
        self.places[index] = position_mm
        return changed

    def restore_places(self) -> None:
        self.places = [HERE] * 8


@dataclass(slots=True)
class Modal:
    """`gc_state`: the state of the G-code parser after a reset and what lines have made of it. Millimetres, mm/min."""

    motion: int = 0
    work: int = 0
    plane: int = 170
    inches: bool = False
    relative: bool = False
    inverse_time: bool = False
    spindle: int = 5
    flood: bool = False
    tool: int = 0
    feed: float = 0.0
    speed: float = 0.0
    position_mm: Vector = HERE
    work_mm: Vector = HERE
    shift_mm: Vector = HERE
    """G92."""
    tool_length_mm: float = 0.0

    @property
    def offset_mm(self) -> Vector:
        """Machine position minus work position, `WCO`."""
        (x, y, z), (sx, sy, sz) = self.work_mm, self.shift_mm
        return x + sx, y + sy, z + sz + self.tool_length_mm

    def line(self, *, report_inches: bool) -> str:
        """What `$G` prints."""
        code = self.motion // 10 if self.motion % 10 == 0 else self.motion / 10
        feed = fixed(self.feed / MM_PER_INCH, 1) if report_inches else fixed(self.feed, 0)
        return (
            f"[GC:G{code} G{54 + self.work} G{self.plane // 10} G{20 if self.inches else 21} "
            f"G{91 if self.relative else 90} G{93 if self.inverse_time else 94} M{self.spindle} "
            f"M{8 if self.flood else 9} T{self.tool} F{feed} S{fixed(self.speed, 0)}]"
        )
