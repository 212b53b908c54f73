"""The parsers that take what others have written, each as a function of bytes, and inputs to begin from."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from daemon.control import Answer, Order, _order
from daemon.errors import LinedrawError
from daemon.program.file import parse_program, program_text
from firmware_protocol.dobot import commands
from firmware_protocol.dobot.packet import PacketReader
from firmware_protocol.dobot.session import DobotSession
from firmware_protocol.dobot.simulator.options import simulator_from as dobot_from
from firmware_protocol.emco.dialects import FANUC, SIEMENS
from firmware_protocol.emco.dnc import Package, Packages, encode
from firmware_protocol.emco.session import BlockSession, XonXoffSession
from firmware_protocol.emco.simulator.interpreter import Interpreter
from firmware_protocol.emco.simulator.motion import line_times_s
from firmware_protocol.emco.simulator.simulator import simulator_from as emco_from
from firmware_protocol.errors import ProtocolError
from firmware_protocol.gcode import clean_line, format_line, read_words
from firmware_protocol.grbl import replies
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.interpreter import Interpreter as GrblInterpreter
from firmware_protocol.grbl.simulator.modal import Memory
from firmware_protocol.grbl.simulator.settings import Settings
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.lines import LineReader
from tests.fuzz.conversations import Line, conversation, said_by


@dataclass(frozen=True, slots=True)
class Target:
    """take: may raise nothing but ProtocolError, or LinedrawError where the daemon itself reads."""

    take: Callable[[bytes], None]
    seeds: Callable[[], list[bytes]]


GRBL_JOB = [Line("G0 Z5")] + [
    Line(text, stroke) for stroke in range(3) for text in ("G0 X1 Y1", "G1 Z0 F600", "G1 X9 Y1 F1200", "X9 Y9", "G0 Z5")
]
DOBOT_JOB = [
    Line(text, stroke)
    for stroke in range(3)
    for text in (
        "PTP 2 215.000 0.000 10.000 0.000",
        "PTP 2 215.000 0.000 0.000 0.000",
        "CP 1 220.000 5.000 0.000 20.000",
        "PTP 2 220.000 5.000 10.000 0.000",
    )
]
EMCO_JOB = [
    Line("%"),
    Line("O0001"),
    Line("G90 G17 G21 G94 G64"),
    Line("G54 G0 Z5."),
    *(
        Line(text, stroke)
        for stroke in range(3)
        for text in ("G0 X1. Y1.", "G1 Z0. F600.", "G1 X9. Y1. F1200.", "G0 Z5.")
    ),
    Line("M30"),
    Line("%"),
]
_PROGRAM = b"\n".join(line.text.encode() for line in GRBL_JOB)
_EMCO_PROGRAM = b"\n".join(line.text.encode() for line in EMCO_JOB)


def _grbl() -> GrblSession:
    return GrblSession(now=0.0, lift=("G21 G90", "G0 Z5"))


def _xonxoff() -> XonXoffSession:
    return XonXoffSession(now=0.0, bytes_per_s=960.0, times=line_times_s)


def _blocks() -> BlockSession:
    return BlockSession(now=0.0, times=line_times_s)


def _dobot() -> DobotSession:
    return DobotSession(now=0.0, home=False, up_mm=10.0)


def _grbl_replies(data: bytes) -> None:
    for line in LineReader().feed(data):
        replies.parse(line)


def _gcode(data: bytes) -> None:
    """What can be read is written and read again; what the controller executes is one of its moves or an error."""
    interpreter = GrblInterpreter(Memory(Settings(None)))
    for raw in data.split(b"\n"):
        with suppress(ProtocolError):
            words = [(word.letter, word.value) for word in read_words(clean_line(raw))]
            assert len(list(read_words(format_line(words)))) == len(words)
        with suppress(ProtocolError):
            list(interpreter.run(clean_line(raw)))


def _grbl_simulator(data: bytes) -> None:
    simulator = GrblSimulator()
    simulator.open(0.0)
    for at in range(0, len(data), 64):
        simulator.receive(data[at : at + 64], simulator.now)
        simulator.advance(simulator.now + 0.1)


def _emco_program(data: bytes) -> None:
    for dialect in (SIEMENS, FANUC, None):
        interpreter = Interpreter(dialect)
        with suppress(ProtocolError):  # a control stops reading at its first alarm
            for line in data.decode("latin-1").split("\n"):
                interpreter.take(line)


def _dobot_packets(data: bytes) -> None:
    """Whatever is a packet is encoded to the bytes that it was."""
    reader = PacketReader()
    for packet in [*reader.feed(data), *reader.give_up()]:
        assert packet.encode() in data
        with suppress(ProtocolError):
            commands.text_of(commands.decode(packet))
        with suppress(ProtocolError):
            commands.answer(packet)


def _dobot_lines(data: bytes) -> None:
    for line in data.decode("latin-1").split("\n"):
        with suppress(ProtocolError):
            commands.parse(commands.text_of(commands.parse(line)))


def _control(data: bytes) -> None:
    for line in data.split(b"\n"):
        assert isinstance(_order(line), Order | Answer)


def _program(data: bytes) -> None:
    program = parse_program(data.decode("ascii", "replace"))
    assert parse_program(program_text(program)).strokes == program.strokes


TARGETS = {
    "grbl replies": Target(_grbl_replies, lambda: [said_by(GrblSimulator(), _grbl(), GRBL_JOB)]),
    "grbl session": Target(conversation(_grbl, GRBL_JOB), lambda: [said_by(GrblSimulator(), _grbl(), GRBL_JOB)]),
    "grbl simulator": Target(_grbl_simulator, lambda: [_PROGRAM, b"$$\n$I\n?$H\n$J=X1F9\n$130=9\n!~\x18$#\n$C\n"]),
    "gcode": Target(_gcode, lambda: [_PROGRAM, b"G2X1Y1I.5J0F9\nG38.2Z-1F9\nG10L20P1X0\nG92X1\n$J=G91X1F1\n"]),
    "emco program": Target(
        _emco_program, lambda: [_EMCO_PROGRAM, b"%_N_AB_MPF\n;$PATH=/_N_MPF_DIR\nG2 X1. Y1. I.5 J0.\n"]
    ),
    "emco xonxoff": Target(conversation(_xonxoff, EMCO_JOB), lambda: [said_by(emco_from({}), _xonxoff(), EMCO_JOB)]),
    "emco blocks": Target(
        conversation(_blocks, EMCO_JOB), lambda: [said_by(emco_from({"link": "blocks"}), _blocks(), EMCO_JOB)]
    ),
    "emco dnc": Target(
        lambda data: list(Packages().feed(data)) and None, lambda: [encode(Package("A", "1", "0", "01", ""))]
    ),
    "dobot packets": Target(_dobot_packets, lambda: [said_by(dobot_from({}), _dobot(), DOBOT_JOB)]),
    "dobot lines": Target(_dobot_lines, lambda: [b"\n".join(line.text.encode() for line in DOBOT_JOB)]),
    "dobot session": Target(
        conversation(_dobot, DOBOT_JOB),
        # An answer counts only when it comes after its question.
        lambda: [said_by(dobot_from({}), _dobot(), DOBOT_JOB, size=6)],
    ),
    "control line": Target(
        _control, lambda: [b'{"order": "jog", "x_mm": 3, "y_mm": -1e3, "job": "12", "seconds": 9}\n']
    ),
    "program file": Target(_program, lambda: [b"(linedrawd: 1 strokes)\n(no stroke)\nG21 G90\n(stroke 0)\nG0 X1 Y1\n"]),
}
"""By the names that `python -m tests.fuzz` takes."""

ALLOWED = (ProtocolError, LinedrawError)
