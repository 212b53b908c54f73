"""The simulated arm: its queue, its motion in time, its alarms, and the ink that it leaves."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from firmware_protocol.dobot import alarms
from firmware_protocol.dobot.commands import Command
from firmware_protocol.dobot.kinematics import Flat, inverse
from firmware_protocol.dobot.simulator import moves
from firmware_protocol.dobot.simulator.motion import Move, Pace
from firmware_protocol.dobot.simulator.trace import Trace
from firmware_protocol.ink import PenRule, Polyline, Vector

_NEVER = float("inf")
_PTP, _HOME, _WAIT = 84, 31, 110


@dataclass(frozen=True, slots=True)
class Build:
    """What differs from arm to arm, or what no document says.

    depth: places in the queue. first_index: of the first command; unused: what is said to have been executed before
    anything was. left_holds_running: the command that runs still counts as one in the queue. clear_resets: clearing
    the queue begins the indices anew. abort_counts: an aborted command is said to have been executed. home_s: how long
    homing takes at least.
    """

    depth: int = 32
    first_index: int = 1
    unused: int = 0
    left_holds_running: bool = True
    clear_resets: bool = False
    home_s: float = 10.0
    abort_counts: bool = False


@dataclass(slots=True)
class _Queued:
    index: int
    command: Command


class Arm:
    """Moved by the clock that is handed in. sheet_origin_mm: where the sheet's lower left corner lies on the arm."""

    def __init__(self, build: Build, pen: PenRule, *, place: Vector, sheet_origin_mm: Flat) -> None:
        self.build = build
        self.now = 0.0
        self.place = place
        """Where the arm believes its tool to be, at rest or at the start of the running move."""
        self.turn_deg = 0.0
        """r, of the tool."""
        self._trace = Trace(pen, sheet_origin_mm)
        self.alarms: set[int] = set()
        self.settings = dict(moves.DEFAULTS)
        self.stands = False
        """Nothing moves any more, whatever is asked."""
        self.waited_on_paper_s = 0.0
        """Time for which the pen has stood on the sheet because the queue was empty."""
        self._waits_since: float | None = None
        self.accepted = 0
        self._reset_queue()

    def _reset_queue(self) -> None:
        self.running = False
        self._queue: deque[_Queued] = deque()
        self._current: _Queued | None = None
        self._moves: deque[Move] = deque()
        self._jog: Move | None = None
        self._began_s = self._until_s = 0.0
        self._next_index = self.build.first_index
        self.executed = self.build.unused

    # -- the queue --

    @property
    def left(self) -> int:
        """Places in the queue."""
        running = self._current is not None and self.build.left_holds_running
        return self.build.depth - len(self._queue) - running

    def enqueue(self, command: Command) -> int | None:
        """The index of the command in the queue; None when it is full, and the command forgotten."""
        if self.left <= 0:
            return None
        index, self._next_index = self._next_index, self._next_index + 1
        self._queue.append(_Queued(index, command))
        self.accepted += 1
        self._start()
        return index

    def run(self) -> None:
        """Begin with the queue."""
        self.running = True
        self._start()

    def stop(self, *, force: bool) -> None:
        """Stop the queue behind the running command; force: at once, and forget that command."""
        self.running = False
        if force and self._current is not None:
            self._cut()
            self.executed = self._current.index if self.build.abort_counts else self.executed
            self._current = None

    def clear(self) -> None:
        """Forget what waits; the running command goes on."""
        self._queue.clear()
        if self.build.clear_resets:
            self._next_index, self.executed = self.build.first_index, self.build.unused

    def clear_alarms(self) -> None:
        """The queue goes on; what caused the alarm brings it back."""
        self.alarms.clear()
        self._start()

    def raise_alarm(self, code: int) -> None:
        """The motion stops, the queue stands still."""
        self._cut()
        self._current = None
        self.alarms.add(code)

    def freeze(self) -> None:
        """Nothing moves any more."""
        self._cut()
        self.stands = True

    def restart(self) -> None:
        """The power was gone: the queue is lost, the base no longer known, and the settings are the first ones."""
        self._cut()
        self._trace.astray_deg += math.degrees(math.atan2(self.place[1], self.place[0]))
        self.place = (math.hypot(*self.place[:2]), 0.0, self.place[2])
        self.settings = dict(moves.DEFAULTS)
        self._reset_queue()
        self.alarms = {alarms.RESET}

    def jog(self, joint: bool, direction: int) -> None:
        """Move as long as it is asked for; direction 0 ends it. The queue waits meanwhile."""
        if self._current is not None or self.stands:
            return
        self._cut()
        self._jog = None
        if 1 <= direction <= 8 and not self.alarms:
            self._begin(moves.jog(joint, direction, self.place, self.settings))
            self._jog = self._moves[0]
        else:
            self._start()

    # -- time --

    def next_s(self) -> float:
        """When the running command or move ends."""
        return self._until_s if (self._current or self._jog) and not self.stands else _NEVER

    def advance(self, now: float) -> None:
        """Let the time pass; call it at every `next_s`."""
        self.now = max(self.now, now)
        while self.next_s() <= self.now:
            ended_s = self._until_s
            if self._moves:
                self._finish_move()
            if self._moves:
                self._begun(self._moves[0], ended_s)
            elif self._jog is not None:
                # It stands at the end of its reach until the jog is ended.
                self._until_s = _NEVER
            else:
                self._finish(ended_s)

    def now_at(self) -> tuple[Vector, float]:
        """Where the arm believes its tool to be now, and r."""
        way = self._way()
        return (way[-1] if way else self.place), self.turn_deg

    @property
    def joints(self) -> tuple[float, float, float]:
        """What the arm believes of its joints."""
        return inverse(self.now_at()[0]) or (0.0, 0.0, 0.0)

    @property
    def ink(self) -> list[Polyline]:
        """On the sheet now, the part of the present move included."""
        return self._trace.ink(self._way())

    def clear_sheet(self) -> None:
        self._trace.clear()

    @property
    def on_paper(self) -> bool:
        """Whether the pen touches the sheet."""
        return self._trace.touches(self.now_at()[0])

    def _start(self) -> None:
        """Begin with the next command, if one may begin."""
        if self._current is not None or self._jog is not None or self.stands:
            return
        while self.running and self._current is None and (queued := self._take()) is not None:
            if self._waits_since is not None:
                self.waited_on_paper_s += self.now - self._waits_since
                self._waits_since = None
            self._execute(queued)

    def _take(self) -> _Queued | None:
        if not self.alarms:
            return self._queue.popleft() if self._queue else None
        # Homing is how an arm with an alarm is recovered.
        queued = next((queued for queued in self._queue if queued.command.kind.id == _HOME), None)
        if queued is not None:
            self._queue.remove(queued)
        return queued

    def _execute(self, queued: _Queued) -> None:
        command, self._current = queued.command, queued
        try:
            ways = self._ways(command)
        except moves.OutOfReach as fault:
            self.alarms.add(fault.code)
            self._queue.appendleft(queued)
            self._current = None
            return
        self._moves = deque(ways)
        self._until_s = self.now
        if ways:
            self._begun(ways[0], self.now)
        elif command.kind.id == _WAIT:
            self._until_s = self.now + int(command.values[0]) / 1000
        if self._until_s <= self.now:
            self._finish(self.now)

    def _ways(self, command: Command) -> list[Move]:
        match command.kind.id:
            case 84:
                return moves.ptp(command, self.place, self.settings)
            case 91 | 92 | 95:
                return moves.cp(command, self.place, self.settings)
            case 31:
                ways = moves.home(self.place, self.settings)
                rest_s = max(0.0, self.build.home_s - sum(way.seconds for way in ways))
                end = ways[-1].end if ways else self.place
                return [*ways, Move((end, end), rest_s, Pace(1.0))]
            case _:
                self.set(command)
                return []

    def set(self, command: Command) -> None:
        """Keep a setting."""
        self.settings[command.kind.id] = command.values

    def _begin(self, move: Move) -> None:
        self._moves = deque([move])
        self._begun(move, self.now)

    def _begun(self, move: Move, now: float) -> None:
        self._began_s, self._until_s = now, now + move.seconds

    def _finish_move(self) -> None:
        move = self._moves.popleft()
        self._trace.draw(move.way)
        self.place = move.end
        if move.alarm is not None:
            self.alarms.add(move.alarm)
            self._moves.clear()
            self._current = None
            self._until_s = _NEVER

    def _finish(self, now: float) -> None:
        queued, self._current = self._current, None
        if queued is None:
            return
        command = queued.command
        self.executed = queued.index
        if command.kind.id == _HOME:
            self._trace.astray_deg = 0.0
        if command.kind.id == _PTP:
            self.turn_deg = float(command.values[4])
        self._start()
        if self._current is None and not self._queue and self.on_paper:
            self._waits_since = now

    def _way(self) -> list[Vector]:
        """What lies behind of the present move."""
        if not self._moves or self.stands:
            return []
        return self._moves[0].until(self.now - self._began_s)

    def _cut(self) -> None:
        way = self._way()
        if way:
            self._trace.draw(way)
            self.place = way[-1]
            self._trace.cut()
        self._moves.clear()
        self._until_s = _NEVER
        self._jog = None
