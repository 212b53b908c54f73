"""Talks to a simulated arm packet by packet."""

from __future__ import annotations

from typing import Any

from firmware_protocol.dobot import alarms, commands
from firmware_protocol.dobot.commands import Values, parse, question
from firmware_protocol.dobot.packet import Packet, PacketReader
from firmware_protocol.dobot.simulator.simulator import DobotSimulator
from firmware_protocol.ink import PenRule

WITHIN_S = 0.05


class Talk:
    """A host that waits for each reply."""

    def __init__(self, *, running: bool = True, **options: Any) -> None:
        self.sim = DobotSimulator(**({"pen": PenRule(down_at_mm=0.0)} | options))
        self.now = 0.0
        self.reader = PacketReader()
        self.sim.open(0.0)
        if running:
            self.do("StartExec")

    def send(self, data: bytes) -> list[Packet]:
        """The packets that come within a moment."""
        self.sim.receive(data, self.now)
        return self.wait(WITHIN_S)

    def wait(self, seconds: float) -> list[Packet]:
        end, data = self.now + seconds, b""
        while (event := self.sim.next_time()) is not None and event <= end:
            data += self.sim.advance(event)
        data += self.sim.advance(end)
        self.now = end
        return self.reader.feed(data)

    def do(self, text: str, *, queued: bool | None = None) -> int | None:
        """A command; the index where it is queued, None where nothing is replied."""
        packets = self.send(parse(text).packet(queued=queued).encode())
        assert len(packets) <= 1
        if not packets:
            return None
        return commands.index_of(packets[0]) if packets[0].queued else 0

    def ask(self, name: str) -> Values:
        (packet,) = self.send(question(name).encode())
        return commands.answer(packet)

    @property
    def place(self) -> tuple[float, ...]:
        return tuple(round(float(value), 3) for value in self.ask("Pose")[:3])  # type: ignore[arg-type]

    @property
    def alarms(self) -> tuple[int, ...]:
        (mask,) = self.ask("Alarms")
        assert isinstance(mask, bytes)
        return alarms.codes(mask)

    def settle(self) -> None:
        """Until nothing more happens."""
        while (event := self.sim.next_time()) is not None:
            self.reader.feed(self.sim.advance(event))
            self.now = max(self.now, event)
