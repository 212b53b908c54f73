"""The `$` settings of GRBL 1.1h on a 328P: their kinds, defaults and how they are stored and printed."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping

from firmware_protocol.gcode import GcodeError

DEFAULTS: Mapping[int, float] = {
    0: 10, 1: 25, 2: 0, 3: 0, 4: 0, 5: 0, 6: 0, 10: 1, 11: 0.01, 12: 0.002, 13: 0, 20: 0, 21: 0, 22: 0, 23: 0,
    24: 25.0, 25: 500.0, 26: 250, 27: 1.0, 30: 1000, 31: 0, 32: 0, 100: 250.0, 101: 250.0, 102: 250.0,
    110: 500.0, 111: 500.0, 112: 500.0, 120: 10.0, 121: 10.0, 122: 10.0, 130: 200.0, 131: 200.0, 132: 200.0,
}  # fmt: skip

_FLOATS = {11, 12, 24, 25, 27, *(base + axis for base in (100, 110, 120, 130) for axis in range(3))}
_SPEEDS = {30, 31}
_FLAGS = {4, 5, 6, 13, 20, 21, 22, 32}

STEP_PULSE_MIN = 6
SOFT_LIMIT_WITHOUT_HOMING = 10
INVALID_STATEMENT = 3
NEGATIVE_VALUE = 4


class Settings:
    """The values as the chip's memory holds them; outlives every reset."""

    def __init__(self, values: Mapping[int, float] | None = None) -> None:
        self.values: dict[int, float] = dict(DEFAULTS)
        for number, value in (values or {}).items():
            if number not in DEFAULTS:
                raise ValueError(f"GRBL has no setting ${number}: take one of {', '.join(f'${n}' for n in DEFAULTS)}")
            self.values[number] = _stored(number, value)

    def __getitem__(self, number: int) -> float:
        return self.values[number]

    def axes(self, base: int) -> tuple[float, float, float]:
        """The values for X, Y and Z of the group from `base` on: 100 steps/mm, 110 mm/min, 120 mm/s2, 130 mm."""
        return self.values[base], self.values[base + 1], self.values[base + 2]

    def store(self, number: int, value: float) -> int:
        """Write one setting. Returns the bytes of the chip's memory that change. Raises GcodeError as GRBL answers."""
        if value < 0:
            raise GcodeError(NEGATIVE_VALUE)
        if number not in DEFAULTS:
            raise GcodeError(INVALID_STATEMENT)
        stored = _stored(number, value)
        if number == 0 and stored < 3:
            raise GcodeError(STEP_PULSE_MIN)
        if number == 20 and stored and not self.values[22]:
            raise GcodeError(SOFT_LIMIT_WITHOUT_HOMING)
        changed = _changed_bytes(number, self.values[number], stored)
        self.values[number] = stored
        if number == 22 and not stored:
            self.values[20] = 0
        return changed

    def restore(self) -> None:
        """Back to the defaults of the build."""
        self.values = dict(DEFAULTS)

    def listing(self) -> list[str]:
        """The lines that `$$` prints."""
        return [f"${number}={_printed(number, value)}" for number, value in self.values.items()]


def fixed(value: float, decimals: int) -> str:
    """A number as GRBL prints it: rounded half away from zero, always that many decimals, `-0.000` possible."""
    scaled = int(abs(value) * 10**decimals + 0.5)
    sign = "-" if value < 0 else ""
    if not decimals:
        return f"{sign}{scaled}"
    whole, part = divmod(scaled, 10**decimals)
    return f"{sign}{whole}.{part:0{decimals}d}"


_LARGEST = 3.4028234663852886e38
"""Of the chip's numbers, which have 32 bits."""


def float_bytes(values: tuple[float, ...]) -> bytes:
    """What the chip's memory holds for these numbers; those that are too large for it end at the largest."""
    return struct.pack(f"<{len(values)}f", *(max(-_LARGEST, min(_LARGEST, value)) for value in values))


def differing(old: bytes, new: bytes) -> int:
    """How many bytes are written when `new` replaces `old`: only those that change."""
    return sum(a != b for a, b in zip(old, new, strict=True))


def _stored(number: int, value: float) -> float:
    if number in _FLOATS or number in _SPEEDS:
        return float(value)
    byte = int(value) & 0xFF
    return float(bool(byte)) if number in _FLAGS else float(byte)


def _changed_bytes(number: int, old: float, new: float) -> int:
    if number in _FLOATS or number in _SPEEDS:
        return differing(float_bytes((old,)), float_bytes((new,)))
    return int(old != new)


def _printed(number: int, value: float) -> str:
    printer: Callable[[float], str] = (lambda v: fixed(v, 3)) if number in _FLOATS else (lambda v: fixed(v, 0))
    return printer(value)
