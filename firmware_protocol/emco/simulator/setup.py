"""How a simulated EMCO control is set up, in Python or by the options of a URL."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from firmware_protocol.emco.dialects import DIALECTS, RAPID_MM_MIN, TRAVEL_MM, Dialect
from firmware_protocol.emco.line_format import FORMATS, LineFormat
from firmware_protocol.emco.simulator.faults import (
    AlarmInBlock,
    Fault,
    FlipBit,
    LoseAck,
    LoseXon,
    PowerCut,
    Reset,
    Stall,
    Unplug,
)
from firmware_protocol.emco.simulator.interpreter import Room
from firmware_protocol.ink import PenRule, Vector

LinkName = Literal["xonxoff", "blocks"]


@dataclass(frozen=True, slots=True)
class Setup:
    """dialect: None takes the one of the program. link: "xonxoff", or "blocks", in which each block is answered by
    `ack` once there is room for it, and by `nak` when its parity is wrong; answers of plain text get a line end.
    buffer_bytes, after_xoff: see `Receiver`. ahead: blocks with motion that are taken in, the running one included.
    software_parity: bytes come and go with a parity bit of their own. start_s: when the operator presses START after
    the port was opened, and after each program's end. repeat_xon_s: XON is said again until bytes come. origin_mm:
    where G54 puts X0 Y0 Z0 within the travel of the axes.
    """

    dialect: Dialect | None = None
    link: LinkName = "xonxoff"
    ack: bytes = b"\x06"
    nak: bytes = b"\x15"
    baud: int = 9600
    line: LineFormat = FORMATS["8N1"]
    software_parity: bool = False
    buffer_bytes: int = 256
    after_xoff: int | None = None
    ahead: int = 2
    start_s: float = 0.0
    repeat_xon_s: float | None = 5.0
    origin_mm: Vector = (0.0, 0.0, 100.0)
    feed_mm_min: float = RAPID_MM_MIN
    acceleration_mm_s2: float = 1000.0

    def __post_init__(self) -> None:
        if self.link not in get_args(LinkName):
            raise ValueError(f"there is no link {self.link!r}: use xonxoff or blocks")
        if not 256 <= self.buffer_bytes <= 1024:
            raise ValueError(f"a buffer of {self.buffer_bytes} bytes is none of a control: use 256 to 1024")
        above_0 = {"baud": self.baud, "ahead": self.ahead, "feed": self.feed_mm_min, "accel": self.acceleration_mm_s2}
        if self.repeat_xon_s is not None:
            above_0["repeat_xon_s"] = self.repeat_xon_s
        for name, value in above_0.items():
            if not value > 0:
                raise ValueError(f"{name} = {value:g} must be above 0")

    @property
    def room(self) -> Room:
        """The travel of the axes in the coordinates of the program."""
        (x, y, z), (width, depth, height) = self.origin_mm, TRAVEL_MM
        return Room((-x, -y, -z), (width - x, depth - y, height - z), self.feed_mm_min)


def _vector(text: str) -> Vector:
    x, y, z = map(float, text.split(":"))
    return x, y, z


def _answer(text: str) -> bytes:
    """Hexadecimal such as 06, or text such as ok."""
    try:
        return bytes.fromhex(text)
    except ValueError:
        return text.encode("ascii")


def _seconds_or_never(text: str) -> float | None:
    return None if text == "never" else float(text)


_SETTINGS: Mapping[str, tuple[str, Callable[[str], Any]]] = {
    "dialect": ("dialect", lambda text: _named(DIALECTS, text)),
    "link": ("link", str),
    "ack": ("ack", _answer),
    "nak": ("nak", _answer),
    "baud": ("baud", int),
    "format": ("line", lambda text: _named(FORMATS, text)),
    "software_parity": ("software_parity", lambda text: bool(int(text))),
    "buffer": ("buffer_bytes", int),
    "after_xoff": ("after_xoff", int),
    "ahead": ("ahead", int),
    "start_s": ("start_s", float),
    "repeat_xon_s": ("repeat_xon_s", _seconds_or_never),
    "origin": ("origin_mm", _vector),
    "feed": ("feed_mm_min", float),
    "accel": ("acceleration_mm_s2", float),
}
_FAULTS: Mapping[str, Callable[[str], Fault]] = {
    "stall": lambda text: Stall(float(text)),
    "lose_xon": lambda text: LoseXon(int(text)),
    "lose_ack": lambda text: LoseAck(int(text)),
    "flip": lambda text: FlipBit(int(text)),
    "alarm_block": lambda text: AlarmInBlock(int(text)),
    "reset": lambda text: Reset(float(text)),
    "power": lambda text: PowerCut(float(text)),
    "unplug": lambda text: Unplug(float(text)),
}
_OTHERS = frozenset({"pen_z", "speed"})
"""`speed` is the transport's: how fast simulated time passes."""


def setup_from(options: Mapping[str, str]) -> tuple[Setup, tuple[Fault, ...], PenRule | None]:
    """Setup, faults and pen of a URL's options. Raises ValueError for one that there is not or that makes no sense."""
    settings: dict[str, Any] = {}
    faults: list[Fault] = []
    for name, text in options.items():
        if name in _SETTINGS:
            field, read = _SETTINGS[name]
            settings[field] = read(text)
        elif name in _FAULTS:
            faults.append(_FAULTS[name](text))
        elif name not in _OTHERS:
            raise ValueError(f"there is no option {name}: known are {', '.join([*_SETTINGS, *_FAULTS, *_OTHERS])}")
    pen = PenRule(down_at_mm=float(options["pen_z"])) if "pen_z" in options else None
    return Setup(**settings), tuple(faults), pen


def _named(table: Mapping[Any, Any], name: str) -> Any:
    if name not in table:
        raise ValueError(f"{name!r} is not known: use {' or '.join(table)}")
    return table[name]
