"""What can go wrong with a simulated EMCO control, on request. Seconds count from the first opening of the port."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class Stall:
    """The control sends XOFF and reads nothing more, ever; what it has read is drawn."""

    at_s: float


@dataclass(frozen=True, slots=True)
class LoseXon:
    """The XON with this number (from 0) never arrives at the host."""

    index: int


@dataclass(frozen=True, slots=True)
class LoseAck:
    """The answer with this number (from 0) never arrives at the host."""

    index: int


@dataclass(frozen=True, slots=True)
class FlipBit:
    """The byte with this number (from 0) arrives with its lowest bit turned over: with parity the control sees it."""

    index: int


@dataclass(frozen=True, slots=True)
class AlarmInBlock:
    """Block n of the program (from 1) raises an alarm: reading stops, nothing is said on the wire."""

    block: int


@dataclass(frozen=True, slots=True)
class Reset:
    """The operator presses RESET: motion stops, everything is forgotten, nothing is said on the wire."""

    at_s: float


@dataclass(frozen=True, slots=True)
class PowerCut:
    """The machine loses its power; the port of the host stays."""

    at_s: float


@dataclass(frozen=True, slots=True)
class Unplug:
    """The cable is pulled at the host: the end of the file. The control draws what it has."""

    at_s: float


Timed: TypeAlias = Stall | Reset | PowerCut | Unplug
Fault: TypeAlias = Timed | LoseXon | LoseAck | FlipBit | AlarmInBlock
