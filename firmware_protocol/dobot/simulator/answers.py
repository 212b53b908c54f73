"""What the simulated arm replies to a packet, and what the packet makes it do."""

from __future__ import annotations

from firmware_protocol.dobot import alarms, commands
from firmware_protocol.dobot.commands import KINDS, Command, Values
from firmware_protocol.dobot.packet import Packet
from firmware_protocol.dobot.simulator.arm import Arm
from firmware_protocol.errors import ProtocolError, RemoteProtocolError

MOTIONS = frozenset({31, 84, 86, 91, 92, 95, 101, 102, 110, 120, 136})
"""What goes into the queue even when it is sent without the mark for it."""

_IDENTITY: dict[int, Values] = {
    0: ("SIMULATED-ARM",),
    1: ("linedrawd",),
    2: (3, 7, 0),
    3: (0,),
    5: (1, 2, 3),
    13: (0.0,),
    41: (0,),
    94: (50.0, 50.0),
    133: (1, 0),
    134: (1, 0),
}


class Answers:
    """left_bytes: how wide the answer to 247 is, 4 or 8."""

    def __init__(self, arm: Arm, *, left_bytes: int = 4) -> None:
        self._arm, self._left_bytes = arm, left_bytes
        self._identity = dict(_IDENTITY)

    def reply(self, packet: Packet) -> Packet | None:
        """None where an arm says nothing: an unknown id, parameters of a wrong size, a full queue."""
        if packet.id not in KINDS:
            return None
        try:
            params = self._write(packet) if packet.write else self._read(packet)
        except ProtocolError:
            return None
        return None if params is None else Packet(packet.id, packet.ctrl, params)

    def _write(self, packet: Packet) -> bytes | None:
        command = self._command(packet)
        if packet.queued or packet.id in MOTIONS:
            index = self._arm.enqueue(command)
            if index is None:
                return None
            return index.to_bytes(8, "little") if packet.queued else b""
        self._do(command)
        return b""

    def _command(self, packet: Packet) -> Command:
        """Parameters that are too long are cut, as a program in C does that copies a structure."""
        try:
            return commands.decode(packet)
        except RemoteProtocolError:
            kind = KINDS[packet.id]
            if kind.writes is None:
                raise
            return commands.decode(Packet(packet.id, packet.ctrl, packet.params[: commands.size(kind.writes)]))

    def _do(self, command: Command) -> None:
        arm = self._arm
        match command.kind.id:
            case 20:
                arm.clear_alarms()
            case 73:
                arm.jog(bool(command.values[0]), int(command.values[1]))
            case 240:
                arm.run()
            case 241 | 242:
                arm.stop(force=command.kind.id == 242)
            case 245:
                arm.clear()
            case 0 | 1 | 3:
                self._identity[command.kind.id] = command.values
            case _:
                arm.set(command)

    def _read(self, packet: Packet) -> bytes:
        kind, arm = KINDS[packet.id], self._arm
        if packet.id == 20:
            return alarms.mask(arm.alarms)
        if packet.id == 247:
            return arm.left.to_bytes(self._left_bytes, "little")
        return commands.answer_params(kind, self._values(packet.id))

    def _values(self, number: int) -> Values:
        arm = self._arm
        match number:
            case 4:
                return (int(arm.now * 1000),)
            case 10:
                place, turn_deg = arm.now_at()
                joints = arm.joints
                return (*place, turn_deg, *joints, turn_deg - joints[0])
            case 246:
                return (arm.executed,)
            case _ if number in self._identity:
                return self._identity[number]
            case _ if number in arm.settings:
                return arm.settings[number]
            case _:
                return commands.zeros(KINDS[number])
