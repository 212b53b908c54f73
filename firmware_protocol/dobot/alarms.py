"""The alarms of a Dobot Magician by name and group, with what to do."""

from __future__ import annotations

from dataclasses import dataclass

MASK_BYTES = 16


@dataclass(frozen=True, slots=True)
class Group:
    """Alarms with one remedy. recoverable: the arm still knows where it is, so the pen can be lifted at once."""

    name: str
    remedy: str
    recoverable: bool = False


@dataclass(frozen=True, slots=True)
class Alarm:
    """One bit of the alarm mask."""

    code: int
    name: str
    group: Group

    @property
    def sentence(self) -> str:
        """What it is and what to do."""
        return f"alarm 0x{self.code:02X} ({self.group.name}: {self.name}): {self.group.remedy}"


_CONTROLLER = Group("controller", "switch the arm off and on, then home it")
_PLANNING = Group("planning", "move the sheet or make the drawing smaller, so that every point is in reach", True)
_MOVING = Group("moving", "move the sheet or make the drawing smaller, so that every way is in reach", True)
_OVERSPEED = Group("overspeed", "draw slower, then home the arm")
_LIMIT = Group("joint limit", "move the arm back by hand with its unlock button, then home it")
_LOST_STEP = Group("lost step", "look what blocks the arm, then home it")
_DRIVER = Group("motor driver", "switch the arm off and on, then home it; if it comes back, the motor needs service")
_UNKNOWN = Group("unknown", "switch the arm off and on, then home it")

GROUPS = {0: _CONTROLLER, 1: _PLANNING, 2: _MOVING, 3: _OVERSPEED, 4: _LIMIT, 5: _LOST_STEP, 6: _DRIVER}
"""By the first hexadecimal digit of the code."""

RESET = 0x00
"""The arm has restarted."""
NO_INVERSE = 0x11
"""No joint angles put the tool at the target."""
BEYOND_LIMIT = 0x12
"""The joint angles of the target are beyond a limit."""
MOVING_OFFSET = 0x10
"""The same on the way to the target."""

_NAMES = {
    0x00: "reset", 0x01: "undefined instruction", 0x02: "file system", 0x03: "MCU to FPGA",
    0x04: "angle sensor", 0x10: "singular target", 0x11: "target out of the workspace",
    0x12: "target beyond a joint limit", 0x13: "the same point twice",
    0x14: "arc that is none", 0x15: "jump parameters", 0x20: "singular way",
    0x21: "way out of the workspace", 0x22: "way beyond a joint limit",
    0x30: "joint 1", 0x31: "joint 2", 0x32: "joint 3", 0x33: "joint 4",
    0x40: "joint 1 +", 0x41: "joint 1 -", 0x42: "joint 2 +", 0x43: "joint 2 -", 0x44: "joint 3 +", 0x45: "joint 3 -",
    0x46: "joint 4 +", 0x47: "joint 4 -", 0x48: "parallelogram +", 0x49: "parallelogram -",
    0x50: "joint 1", 0x51: "joint 2", 0x52: "joint 3", 0x53: "joint 4",
    0x60: "driver of axis 1", 0x61: "overflow of axis 1", 0x62: "axis 1 does not follow",
    0x63: "driver of axis 2", 0x64: "overflow of axis 2", 0x65: "axis 2 does not follow",
    0x66: "driver of axis 3", 0x67: "overflow of axis 3", 0x68: "axis 3 does not follow",
    0x69: "driver of axis 4", 0x6A: "overflow of axis 4", 0x6B: "axis 4 does not follow",
    0x6C: "invalid parameter (documented for the Magician Lite only)",
}  # fmt: skip

ALARMS = {code: Alarm(code, name, GROUPS[code >> 4]) for code, name in _NAMES.items()}
"""Every documented alarm by its code."""


def alarm(code: int) -> Alarm:
    """The alarm of this code; one that no document knows is called unknown."""
    return ALARMS.get(code) or Alarm(code, "undocumented", GROUPS.get(code >> 4, _UNKNOWN))


def codes(mask: bytes) -> tuple[int, ...]:
    """The codes that a mask holds: byte times 8 plus bit. Bytes beyond the sixteenth are no alarms."""
    bits = int.from_bytes(mask[:MASK_BYTES], "little")
    return tuple(code for code in range(8 * MASK_BYTES) if bits >> code & 1)


def mask(active: set[int]) -> bytes:
    """The mask that holds these codes."""
    return sum(1 << code for code in active).to_bytes(MASK_BYTES, "little")


def sentence(active: tuple[int, ...]) -> str:
    """All of them, for a person."""
    return "; ".join(alarm(code).sentence for code in active)


def recoverable(active: tuple[int, ...]) -> bool:
    """Whether the arm still knows where it is."""
    return all(alarm(code).group.recoverable for code in active)
