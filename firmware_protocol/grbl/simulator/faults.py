"""What can go wrong with a simulated controller, on request."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.simulator import Moment


@dataclass(frozen=True, slots=True)
class DropByte:
    """The byte with this number (from 0, counted since the port was opened) never arrives at the controller."""

    index: int


@dataclass(frozen=True, slots=True)
class FlipByte:
    """The byte with this number arrives with these bits turned over."""

    index: int
    bits: int = 0x01


@dataclass(frozen=True, slots=True)
class LoseOk:
    """The `ok` with this number (from 0, counted since the port was opened) never arrives at the host."""

    index: int


@dataclass(frozen=True, slots=True)
class SlowUsb:
    """What either side sends waits in the USB converter for up to `latency_s`, as with a latency timer; 0 mends it."""

    latency_s: float

    def __post_init__(self) -> None:
        if not 0 <= self.latency_s <= 1:
            raise ValueError(f"a USB latency of {self.latency_s:g} s is not simulated: take 0 to 1")


@dataclass(frozen=True, slots=True)
class UnsaidAlarm:
    """The next reset in motion or limit switch is not called an alarm: the banner comes at once, then Idle.

    A race of the firmware, seen in one of twenty trips of a hard limit and in one of a hundred resets in motion.
    """


@dataclass(frozen=True, slots=True)
class Hang(Moment):
    """The chip stops: no step, no answer, until the port is opened again."""


@dataclass(frozen=True, slots=True)
class BrownOut(Moment):
    """The chip restarts by itself: motion stops, banner, position 0, Idle without any alarm (with $22=1: Alarm)."""


@dataclass(frozen=True, slots=True)
class HardLimit(Moment):
    """A limit switch trips as with $21=1: ALARM:1, whatever $21 says."""


@dataclass(frozen=True, slots=True)
class Unplug(Moment):
    """The cable is pulled, and with it the power of the chip."""


Timed: TypeAlias = Hang | BrownOut | HardLimit | Unplug
Fault: TypeAlias = DropByte | FlipByte | LoseOk | SlowUsb | UnsaidAlarm | Timed
