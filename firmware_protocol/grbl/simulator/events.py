"""What happens to a simulated controller from outside, as a sentence: `limit x closed`, `lose byte`, `unplug`."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.grbl.simulator.faults import (
    BrownOut,
    DropByte,
    FlipByte,
    Hang,
    LoseOk,
    SlowUsb,
    Unplug,
    UnsaidAlarm,
)


@dataclass(frozen=True, slots=True)
class AllOpen:
    """No switch, contact or pin is active any more; the places of later switches count from here."""


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit switch is pressed by hand, or let go."""

    axis: int
    closed: bool


@dataclass(frozen=True, slots=True)
class LimitAt:
    """A limit switch is closed at and beyond a place, counted from where all inputs were opened; below 0: below it."""

    axis: int
    place_mm: float
    upwards: bool


@dataclass(frozen=True, slots=True)
class Contact:
    """The probe gets or loses contact."""

    closed: bool


@dataclass(frozen=True, slots=True)
class Surface:
    """The probe has contact at and below a height, counted from where all inputs were opened."""

    height_mm: float


@dataclass(frozen=True, slots=True)
class Pin:
    """The pin `hold`, `start` or `reset` is pulled low, or let go."""

    name: str
    low: bool


@dataclass(frozen=True, slots=True)
class HardwareReset:
    """The reset pin, or DTR: then the boot loader hears nothing for `deaf_s`."""

    deaf_s: float = 0.0


@dataclass(frozen=True, slots=True)
class PlugIn:
    """The cable is back."""


Touch: TypeAlias = AllOpen | Limit | LimitAt | Contact | Surface | Pin
"""What changes an input of the controller."""
Event: TypeAlias = (
    Touch | HardwareReset | PlugIn | DropByte | FlipByte | LoseOk | SlowUsb | UnsaidAlarm | Hang | BrownOut | Unplug
)
"""Numbers of bytes and answers are counted from now on."""

SENTENCES = (
    "all inputs open", "limit x|y|z closed|open", "switch x|y|z closes at +4.000 mm", "probe closed|open",
    "probe contact at and below z -0.500 mm", "pin hold|start|reset low|high", "hardware reset",
    "dtr reset (boot loader deaf for 1.5 s)", "lose byte [N]", "flip byte [N] [bits B]", "lose ok [N]", "hang",
    "brown-out", "unplug", "plug in", "slow usb T ms", "unsaid alarm",
)  # fmt: skip
"""Everything that `read_event` understands; N counts from 0, which is the next one."""

_NUMBER = r"([+-]?\d+(?:\.\d+)?)"
_Reader: TypeAlias = Callable[..., Event]


def read_event(sentence: str) -> Event:
    """The event that a sentence of `SENTENCES` tells. Raises ValueError for any other."""
    text = " ".join(sentence.lower().split())
    for pattern, reader in _READERS:
        if found := pattern.fullmatch(text):
            return reader(*found.groups())
    raise ValueError(f"there is no event {sentence!r}: write one of {'; '.join(SENTENCES)}")


def _limit_at(axis: str, place: str) -> Event:
    return LimitAt("xyz".index(axis), float(place), upwards=not place.startswith("-"))


def _flip(index: str | None, bits: str | None) -> Event:
    return FlipByte(int(index or 0), int(bits or "1", 0) & 0xFF)


_READERS: tuple[tuple[re.Pattern[str], _Reader], ...] = tuple(
    (re.compile(pattern), reader)
    for pattern, reader in (
        ("all inputs open", AllOpen),
        ("limit ([xyz]) (closed|open)", lambda axis, how: Limit("xyz".index(axis), how == "closed")),
        (f"switch ([xyz]) closes at {_NUMBER} mm", _limit_at),
        ("probe (closed|open)", lambda how: Contact(how == "closed")),
        (f"probe contact at and below z {_NUMBER} mm", lambda height: Surface(float(height))),
        ("pin (hold|start|reset) (low|high)", lambda name, how: Pin(name, how == "low")),
        ("hardware reset", HardwareReset),
        (r"dtr reset(?: \(boot loader deaf for (\d+(?:\.\d+)?) s\))?", lambda deaf: HardwareReset(float(deaf or 0))),
        (r"lose byte(?: (\d+))?", lambda index: DropByte(int(index or 0))),
        (r"flip byte(?: (\d+))?(?: bits (\d+|0x[0-9a-f]+))?", _flip),
        (r"lose ok(?: (\d+))?", lambda index: LoseOk(int(index or 0))),
        ("hang", lambda: Hang(at_s=0.0)),
        ("brown-out", lambda: BrownOut(at_s=0.0)),
        ("unplug", lambda: Unplug(at_s=0.0)),
        ("plug in", PlugIn),
        ("unsaid alarm", UnsaidAlarm),
        (r"slow usb (\d+(?:\.\d+)?) ms", lambda latency: SlowUsb(float(latency) / 1000)),
    )
)
