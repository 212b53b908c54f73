"""Session and simulated controller talk to each other at wire speed, and the ink is compared with what was said."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.faults import BrownOut, DropByte, FlipByte, Hang, HardLimit, LoseOk, Unplug
from firmware_protocol.grbl.simulator.simulator import GrblSimulator, PenRule
from firmware_protocol.session import Accepted, Ended, Event, NotReady, Ready, Status, Verdict
from tests.firmware_protocol.grbl.driver import Line

LIFT = ("G90 G21", "G0 Z5")
FAST = {1: 255, 110: 3000, 111: 3000, 112: 3000, 120: 200, 121: 200, 122: 200}
STROKES = 12


def strokes(count: int = STROKES) -> list[Line]:
    """Vertical lines of 10 mm, 2 mm apart."""
    lines = [Line("G21 G90 G0 Z5")]
    for stroke in range(count):
        x = 2 * stroke
        lines += [
            Line(f"G0 X{x} Y0", stroke),
            Line("G1 Z0 F1500", stroke),
            Line("G1 Y10 F1500", stroke),
            Line("G0 Z5", stroke),
        ]
    return [*lines, Line("G0 X0 Y0"), Line("M30")]


class Bench:
    """A session and a simulator on one clock."""

    def __init__(self, sim: GrblSimulator, **options: object) -> None:
        self.sim, self.now, self.events = sim, 0.0, list[Event]()
        sim.open(0.0)
        self.session = GrblSession(now=0.0, **({"lift": LIFT} | options))  # type: ignore[arg-type]
        self.sent = b""

    def run(self, until: type[Event], *, within_s: float = 120.0) -> list[Event]:
        """Let time pass until an event of that type."""
        limit_s = self.now + within_s
        while self.now < limit_s and not any(isinstance(event, until) for event in self.events):
            if self.sim.unplugged:
                self.events += self.session.unplugged(self.now)
                continue
            self._exchange(limit_s)
        return self.events

    def _exchange(self, limit_s: float) -> None:
        data = self.session.data_to_send(self.now)
        self.sent += data
        self.sim.receive(data, self.now)
        times = [at for at in (self.sim.next_time(), self.session.deadline(), limit_s) if at is not None]
        self.now = max(self.now, min(times))
        self.events += self.session.receive(self.sim.advance(self.now), self.now)
        self.events += self.session.expire(self.now)

    def draw(self, lines: list[Line], *, stop_after: int | None = None) -> Ended:
        self.run(Ready)
        self.events = [event for event in self.events if isinstance(event, Ready)]
        self.session.start(lines, self.now)
        if stop_after is not None:
            while Accepted(stop_after) not in self.events:
                self._exchange(self.now + 1.0)
            self.session.stop(self.now)
        self.run(Ended)
        (end,) = [event for event in self.events if isinstance(event, Ended)]
        return end

    @property
    def whole(self) -> int:
        """The first so many strokes are whole on the sheet."""
        full = {round(line[0][0]) for line in self.sim.ink if abs(line[-1][1] - line[0][1]) > 9.99}
        return next(stroke for stroke in range(STROKES + 1) if 2 * stroke not in full)

    @property
    def touched(self) -> int:
        """No stroke from this number on has any ink."""
        return max((round(line[0][0]) // 2 + 1 for line in self.sim.ink), default=0)


def plotter(**options: object) -> GrblSimulator:
    return GrblSimulator(settings=FAST, pen=PenRule(), **options)  # type: ignore[arg-type]


def told_truth(bench: Bench, end: Ended) -> bool:
    return end.strokes_certain <= bench.whole and bench.touched <= end.strokes_possible


@pytest.mark.parametrize("flow", ["count", "line"])
def test_a_job_is_finished_when_its_last_ink_is_on_the_sheet(flow: str) -> None:
    bench = Bench(plotter(), flow=flow)
    end = bench.draw(strokes())
    assert (end.verdict, end.strokes_certain, end.pen_lifted) == (Verdict.FINISHED, STROKES, True)
    assert (bench.whole, bench.sim.overflows, bench.sim.lost_bytes) == (STROKES, 0, 0)
    assert bench.sim.position_mm == pytest.approx((0.0, 0.0, 5.0))


def test_every_line_is_accepted_once_and_in_order() -> None:
    bench = Bench(plotter())
    bench.draw(strokes())
    assert [event.line for event in bench.events if isinstance(event, Accepted)] == list(range(len(strokes())))


def test_a_board_with_a_deaf_boot_loader_is_found() -> None:
    bench = Bench(plotter(boot_s=1.5))
    assert any(isinstance(event, Ready) for event in bench.run(Ready))


def test_a_locked_board_is_not_ready_unless_it_is_homed() -> None:
    locked = {**FAST, 22: 1}
    bench = Bench(GrblSimulator(settings=locked))
    assert any(isinstance(event, NotReady) for event in bench.run(NotReady))
    homed = Bench(GrblSimulator(settings=locked, switches_mm=(3.0, 3.0, 3.0)), home=True)
    assert any(isinstance(event, Ready) for event in homed.run(Ready))


@pytest.mark.parametrize("line", [3, 9, 20, 33])
def test_a_stop_keeps_the_position_lifts_the_pen_and_tells_the_truth(line: int) -> None:
    bench = Bench(plotter())
    end = bench.draw(strokes(), stop_after=line)
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.STOPPED, True, True)
    assert bench.sim.position_mm[2] == pytest.approx(5.0)
    assert told_truth(bench, end)
    report = [event for event in bench.events if isinstance(event, Status)][-1]
    assert report.position_mm[:2] == pytest.approx(bench.sim.position_mm[:2], abs=0.01)


def test_after_a_stop_the_rest_is_drawn_on_the_same_session() -> None:
    bench = Bench(plotter())
    end = bench.draw(strokes(), stop_after=20)
    rest = [line for line in strokes() if line.stroke is None or line.stroke >= end.strokes_certain]
    assert bench.draw(rest).verdict is Verdict.FINISHED
    assert bench.whole == STROKES


def test_a_refused_line_ends_the_job_and_what_is_on_the_sheet_is_told() -> None:
    bench = Bench(plotter())
    lines = strokes()
    end = bench.draw([*lines[:20], Line("G64", 4), *lines[20:]])
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.REJECTED, True, True)
    assert "line 21 ('G64') was refused with error:20" in end.why
    assert told_truth(bench, end)


@pytest.mark.parametrize(
    ("fault", "verdict", "known", "lifted"),
    [
        (HardLimit(after_acks=22), Verdict.ALARM, False, False),
        (BrownOut(after_acks=22), Verdict.RESTARTED, False, True),
        (Hang(after_acks=22), Verdict.SILENT, False, False),
        (Unplug(after_acks=22), Verdict.UNPLUGGED, False, False),
        (LoseOk(22), Verdict.SILENT, True, True),
    ],
)
def test_every_fault_ends_the_job_once_and_tells_the_truth(
    fault: object, verdict: Verdict, known: bool, lifted: bool
) -> None:
    bench = Bench(plotter(faults=[fault]))
    end = bench.draw(strokes())
    assert (end.verdict, end.position_known, end.pen_lifted) == (verdict, known, lifted)
    assert told_truth(bench, end)


def test_a_lost_line_end_stops_the_job() -> None:
    probe = Bench(plotter())
    probe.draw(strokes())
    bench = Bench(plotter(faults=[DropByte(probe.sent.index(b"Z5\n", 330) + 2)]))
    end = bench.draw(strokes())
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.REJECTED, True, True)
    assert told_truth(bench, end)


def test_a_byte_flipped_into_a_reset_is_an_alarm_and_ends_the_job() -> None:
    probe = Bench(plotter())
    probe.draw(strokes())
    at = probe.sent.index(b"X", 330)
    bench = Bench(plotter(faults=[FlipByte(at, ord("X") ^ 0x18)]))
    end = bench.draw(strokes())
    assert end.verdict in {Verdict.ALARM, Verdict.RESTARTED}
    assert told_truth(bench, end)
