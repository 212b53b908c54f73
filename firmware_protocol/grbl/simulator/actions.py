"""What a line of G-code makes the controller do, in order, once GRBL has found no fault in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.grbl.simulator.lookahead import Move, Vector


@dataclass(frozen=True, slots=True)
class Dwell:
    """G4: wait, after all motion has ended."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Spindle:
    """M3, M4, M5 or a new S while turning: after all motion has ended. A pen servo hangs on it."""

    direction: int
    """3, 4 or 5, the number of its M."""
    speed: float


@dataclass(frozen=True, slots=True)
class Coolant:
    """M8 or M9, after all motion has ended."""

    flood: bool


@dataclass(frozen=True, slots=True)
class Remember:
    """G10, G28.1, G30.1: write to the chip's memory, after all motion has ended; `changed` bytes differ."""

    changed: int


@dataclass(frozen=True, slots=True)
class Probe:
    """G38.2 to G38.5: towards the target until the probe's contact changes."""

    move: Move
    away: bool
    alarm: bool


@dataclass(frozen=True, slots=True)
class Pause:
    """M0: hold, after all motion has ended, until `~`."""


@dataclass(frozen=True, slots=True)
class ProgramEnd:
    """M2, M30."""


Action: TypeAlias = Move | Dwell | Spindle | Coolant | Remember | Probe | Pause | ProgramEnd

__all__ = [
    "Action", "Coolant", "Dwell", "Move", "Pause", "Probe", "ProgramEnd", "Remember", "Spindle", "Vector",
]  # fmt: skip
