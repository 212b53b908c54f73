"""What is wired to the simulated controller: limit switches, the probe's contact and its pins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from firmware_protocol.grbl.simulator.events import AllOpen, Contact, Limit, LimitAt, Pin, Surface, Touch
from firmware_protocol.grbl.simulator.lookahead import Vector

_SAME_MM = 1e-6


class Switch(NamedTuple):
    """A limit switch that the machine pushes: closed from `place_mm` on, upwards or downwards, on the sheet."""

    place_mm: float
    upwards: bool

    def closed(self, at_mm: float) -> bool:
        """Whether it is closed while its axis stands there."""
        beyond = at_mm - self.place_mm if self.upwards else self.place_mm - at_mm
        return beyond >= -_SAME_MM


@dataclass(frozen=True, slots=True)
class Inputs:
    """Places are counted on the sheet: the controller may forget where it is, a switch stays where it is screwed on."""

    held: frozenset[int] = frozenset()
    """Axes whose limit switch is closed wherever the machine stands."""
    switches: Mapping[int, Switch] = field(default_factory=dict)
    touching: bool = False
    """The probe has contact wherever the machine stands."""
    surface_mm: float | None = None
    """The probe has contact at and below this height."""
    pins: frozenset[str] = frozenset()
    """Those of hold, start and reset that are low: pressed."""

    @property
    def depend_on_place(self) -> bool:
        """Whether motion alone can change what is closed."""
        return bool(self.switches) or self.surface_mm is not None

    def limits(self, at_mm: Vector) -> frozenset[int]:
        """The axes whose limit switch is closed while the machine stands there."""
        pushed = {axis for axis, switch in self.switches.items() if switch.closed(at_mm[axis])}
        return self.held | pushed

    def contact(self, at_mm: Vector) -> bool:
        """Whether the probe touches while the machine stands there."""
        return self.touching or (self.surface_mm is not None and at_mm[2] <= self.surface_mm + _SAME_MM)

    def after(self, event: Touch, origin_mm: Vector) -> Inputs:
        """The same with what `event` changes; its places are counted from `origin_mm` on the sheet."""
        match event:
            case AllOpen():
                return Inputs()
            case Limit(axis, closed):
                return replace(self, held=self.held | {axis} if closed else self.held - {axis})
            case LimitAt(axis, place_mm, upwards):
                switch = Switch(origin_mm[axis] + place_mm, upwards)
                return replace(self, switches={**self.switches, axis: switch})
            case Contact(closed):
                return replace(self, touching=closed)
            case Surface(height_mm):
                return replace(self, surface_mm=origin_mm[2] + height_mm)
            case Pin(name, low):
                return replace(self, pins=self.pins | {name} if low else self.pins - {name})
