"""The commands of a Dobot Magician: one table, to packets and back, and as readable text.

A command as text is its name and its fields: `CP 1 210.000 5.000 20.000 60.000`.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.dobot.packet import LONGEST_LENGTH, Packet, ctrl
from firmware_protocol.errors import LocalProtocolError, RemoteProtocolError
from firmware_protocol.pens import is_pen_change

Value: TypeAlias = float | int | str | bytes
Values: TypeAlias = tuple[Value, ...]

TEXT = "text"
"""In the place of a structure: characters up to a NUL."""


@dataclass(frozen=True, slots=True)
class Kind:
    """One command of the table. writes, reads: structure of what is written and of what a read returns, None: neither.

    fields: the names of what is written, or read where nothing is written. queued: it may be put into the queue.
    optional: the parameters may be missing.
    """

    id: int
    name: str
    writes: str | None
    reads: str | None
    queued: bool = False
    fields: tuple[str, ...] = ()
    optional: bool = False


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


_XYZR = _names("x_mm y_mm z_mm r_deg")
_VELOCITIES = _names("v1 v2 v3 v4 a1 a2 a3 a4")
_RATIOS = _names("velocity_percent acceleration_percent")
_SWITCH = _names("enabled on")
_PIN = _names("pin value")

_TABLE = (
    Kind(0, "DeviceSN", TEXT, TEXT, fields=("text",)),
    Kind(1, "DeviceName", TEXT, TEXT, fields=("text",)),
    Kind(2, "DeviceVersion", None, "<3B", fields=_names("major minor revision")),
    Kind(3, "DeviceWithL", "<B", "<B", fields=("rail",)),
    Kind(4, "DeviceTime", None, "<I", fields=("ms",)),
    Kind(5, "DeviceID", None, "<3I", fields=_names("id1 id2 id3")),
    Kind(10, "Pose", None, "<8f", fields=(*_XYZR, *_names("j1_deg j2_deg j3_deg j4_deg"))),
    Kind(11, "ResetPose", "<B2f", None, fields=_names("manual rear_deg front_deg")),
    Kind(13, "PoseL", None, "<f", fields=("rail_mm",)),
    Kind(20, "Alarms", "", "16s"),
    Kind(30, "HOMEParams", "<4f", "<4f", True, _XYZR),
    Kind(31, "HOME", "<I", None, True, ("reserved",), optional=True),
    Kind(41, "HHTTrigOutput", "<B", "<B", True, ("enabled",)),
    Kind(60, "EndEffectorParams", "<3f", "<3f", True, _names("x_mm y_mm z_mm")),
    Kind(61, "Laser", "<2B", "<2B", True, _SWITCH),
    Kind(62, "SuctionCup", "<2B", "<2B", True, _SWITCH),
    Kind(63, "Gripper", "<2B", "<2B", True, _SWITCH),
    Kind(70, "JOGJointParams", "<8f", "<8f", True, _VELOCITIES),
    Kind(71, "JOGCoordinateParams", "<8f", "<8f", True, _VELOCITIES),
    Kind(72, "JOGCommonParams", "<2f", "<2f", True, _RATIOS),
    Kind(73, "JOG", "<2B", None, True, _names("joint direction")),
    Kind(80, "PTPJointParams", "<8f", "<8f", True, _VELOCITIES),
    Kind(81, "PTPCoordinateParams", "<4f", "<4f", True, _names("xyz_mm_s r_deg_s xyz_mm_s2 r_deg_s2")),
    Kind(82, "PTPJumpParams", "<2f", "<2f", True, _names("height_mm limit_mm")),
    Kind(83, "PTPCommonParams", "<2f", "<2f", True, _RATIOS),
    Kind(84, "PTP", "<B4f", None, True, ("mode", *_XYZR)),
    Kind(85, "PTPLParams", "<2f", "<2f", True, _RATIOS),
    Kind(86, "PTPWithL", "<B5f", None, True, ("mode", *_XYZR, "rail_mm")),
    Kind(87, "PTPJump2Params", "<3f", "<3f", True, _names("start_mm end_mm limit_mm")),
    Kind(90, "CPParams", "<3fB", "<3fB", True, _names("plan_mm_s2 junction_mm_s mm_s2_or_period real_time")),
    Kind(91, "CP", "<B4f", None, True, _names("mode x_mm y_mm z_mm mm_s")),
    Kind(92, "CPLE", "<B4f", None, True, _names("mode x_mm y_mm z_mm power_percent")),
    Kind(94, "CPCommonParams", "<2f", "<2f", True, _RATIOS),
    Kind(95, "CP2", "<B3f", None, True, _names("mode x_mm y_mm z_mm")),
    Kind(100, "ARCParams", "<4f", "<4f", True, _names("xyz_mm_s r_deg_s xyz_mm_s2 r_deg_s2")),
    Kind(101, "ARC", "<8f", None, True, _names("via_x via_y via_z via_r to_x to_y to_z to_r")),
    Kind(102, "Circle", "<8fI", None, True, _names("via_x via_y via_z via_r to_x to_y to_z to_r turns")),
    Kind(110, "WAIT", "<I", None, True, ("ms",)),
    Kind(120, "TRIG", "<3BH", None, True, _names("pin mode condition threshold")),
    Kind(130, "IOMultiplexing", "<2B", "<2B", True, _PIN),
    Kind(131, "IODO", "<2B", "<2B", True, _PIN),
    Kind(132, "IOPWM", "<B2f", "<B2f", True, _names("pin hz duty_percent")),
    Kind(133, "IODI", None, "<2B", fields=_PIN),
    Kind(134, "IOADC", None, "<BH", fields=_PIN),
    Kind(135, "EMotor", "<2Bi", None, True, _names("motor enabled pulses_s")),
    Kind(136, "EMotorS", "<2BiI", None, True, _names("motor enabled pulses_s pulses")),
    Kind(240, "StartExec", "", None),
    Kind(241, "StopExec", "", None),
    Kind(242, "ForceStopExec", "", None),
    Kind(243, "StartDownload", "<2I", None, fields=_names("loops lines")),
    Kind(244, "StopDownload", "", None),
    Kind(245, "Clear", "", None),
    Kind(246, "CurrentIndex", None, "<Q", fields=("index",)),
    Kind(247, "LeftSpace", None, "<I", fields=("left",)),
)

KINDS = {kind.id: kind for kind in _TABLE}
"""By id."""
BY_NAME = {kind.name: kind for kind in _TABLE}

NONE_YET = 0xFFFFFFFFFFFFFFFF
"""What some arms call the index of the last executed command before anything was executed; others say 0."""
MOVL_XYZ = 2
"""Modes of PTP: all joints at once, and in a straight line."""
PTP_TO_A_PLACE = frozenset({0, 1, 2, 3, 4, 5, 9})
"""Modes of PTP that state where to go; the others state how far."""
RELATIVE, ABSOLUTE = 0, 1
"""Modes of CP."""


@dataclass(frozen=True, slots=True)
class Command:
    """Something that is written: a command of the table and its fields, numbers as the structure wants them."""

    kind: Kind
    values: Values = ()

    def packet(self, *, queued: bool | None = None) -> Packet:
        """Into the queue where that may be, unless stated otherwise. Raises LocalProtocolError for what cannot be."""
        return Packet(
            self.kind.id, ctrl(write=True, queued=self.kind.queued if queued is None else queued), self._params()
        )

    def _params(self) -> bytes:
        kind = self.kind
        if kind.writes is None:
            raise LocalProtocolError(f"{kind.name} cannot be written: only read it")
        if kind.optional and not self.values:
            return b""
        if kind.writes == TEXT:
            return _text_bytes(kind, self.values)
        try:
            return struct.pack(kind.writes, *self.values)
        except (struct.error, OverflowError) as error:
            raise LocalProtocolError(
                f"{kind.name} takes {' '.join(kind.fields) or 'nothing'}, not {self.values}"
            ) from error


def command(name: str, *values: Value) -> Command:
    """A command by its name. Raises LocalProtocolError when there is none."""
    if name not in BY_NAME:
        raise LocalProtocolError(f"there is no command {name!r}: the commands are {', '.join(BY_NAME)}")
    return Command(BY_NAME[name], values)


def question(name: str) -> Packet:
    """The packet that reads what `name` stands for."""
    kind = command(name).kind
    if kind.reads is None:
        raise LocalProtocolError(f"{name} cannot be read: only write it")
    return Packet(kind.id, ctrl())


def decode(packet: Packet) -> Command:
    """What a request writes. Raises RemoteProtocolError for an unknown id, or parameters of another size."""
    kind = _known(packet)
    if kind.writes is None or not packet.write:
        raise RemoteProtocolError(f"{kind.name} with ctrl {packet.ctrl:#04x} writes nothing")
    if kind.optional and not packet.params:
        return Command(kind)
    return Command(kind, _unpacked(kind, kind.writes, packet.params, longer=False))


def answer(packet: Packet) -> Values:
    """What the arm's answer to a question says; longer answers of newer arms are cut. Raises RemoteProtocolError."""
    kind = _known(packet)
    if kind.reads is None:
        raise RemoteProtocolError(f"{kind.name} is no question, so it has no answer")
    return _unpacked(kind, kind.reads, packet.params, longer=True)


def answer_params(kind: Kind, values: Values) -> bytes:
    """The parameters of an answer that says `values`. Raises LocalProtocolError."""
    return Command(Kind(kind.id, kind.name, kind.reads, None, fields=kind.fields), values)._params()


def size(structure: str) -> int:
    """Bytes of the parameters; a text may be of any length."""
    return LONGEST_LENGTH if structure == TEXT else struct.calcsize(structure)


def zeros(kind: Kind) -> Values:
    """An answer that says nothing but noughts."""
    return answer(Packet(kind.id, ctrl(), bytes(size(kind.reads or ""))))


def index_of(packet: Packet) -> int:
    """The place in the queue that the arm acknowledges. Raises RemoteProtocolError when it holds none."""
    if len(packet.params) < 8:
        raise RemoteProtocolError(f"an acknowledgement of {len(packet.params)} bytes holds no index: expected 8")
    return int.from_bytes(packet.params[:8], "little")


def text_of(written: Command) -> str:
    """A command in one line: its name, whole numbers as they are, the others with three decimals."""
    codes = field_codes(written.kind.writes or "")
    words = [
        f"{round(float(value), 3) + 0.0:.3f}" if code == "f" else str(value)
        for value, code in zip(written.values, codes, strict=False)
    ]
    return " ".join([written.kind.name, *words])


def parse(text: str) -> Command:
    """The command that a line holds; for the arm a pen change is a moment of rest.

    Raises LocalProtocolError that says what is wrong with it.
    """
    if is_pen_change(text):
        return command("WAIT", 1)
    name, *words = text.split(" ")
    kind = command(name).kind
    if kind.writes is None:
        raise LocalProtocolError(f"{text!r}: {name} cannot be written")
    if kind.writes == TEXT:
        return Command(kind, (" ".join(words),))
    if kind.optional and not words:
        return Command(kind)
    codes = field_codes(kind.writes)
    if len(words) != len(codes):
        raise LocalProtocolError(f"{text!r}: {name} takes {' '.join(kind.fields) or 'nothing'}")
    try:
        values = tuple(float(word) if code == "f" else int(word) for word, code in zip(words, codes, strict=True))
    except ValueError as error:
        raise LocalProtocolError(f"{text!r}: {error}") from error
    if not all(math.isfinite(value) for value in values):
        raise LocalProtocolError(f"{text!r}: every number must be finite")
    parsed = Command(kind, values)
    parsed.packet()
    return parsed


def _known(packet: Packet) -> Kind:
    if packet.id not in KINDS:
        raise RemoteProtocolError(f"there is no command {packet.id}")
    return KINDS[packet.id]


def _unpacked(kind: Kind, structure: str, params: bytes, *, longer: bool) -> Values:
    if structure == TEXT:
        return (params.split(b"\0")[0].decode("latin-1"),)
    size = struct.calcsize(structure)
    if len(params) < size or (len(params) > size and not longer):
        raise RemoteProtocolError(f"{kind.name} has {len(params)} bytes of parameters instead of {size}")
    return struct.unpack(structure, params[:size])


def _text_bytes(kind: Kind, values: Values) -> bytes:
    try:
        (text,) = values
        return str(text).encode("latin-1") + b"\0"
    except (ValueError, UnicodeEncodeError) as error:
        raise LocalProtocolError(f"{kind.name} takes one text of plain letters, not {values}") from error


def field_codes(structure: str) -> str:
    """One letter a field: `<B2f` becomes `Bff`."""
    if structure == TEXT:
        return "s"
    codes, count = "", ""
    for letter in structure.lstrip("<"):
        if letter.isdecimal():
            count += letter
        else:
            codes, count = codes + letter * int(count or 1), ""
    return codes
