"""The loop of bytes and time, on a simulated controller."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from daemon.errors import LinedrawError, MachineFault, NoMachine
from daemon.machine.link import Link
from daemon.machine.simulated import SimulatedTransport
from daemon.shapes import ProgramLine
from firmware_protocol.emco.session import XonXoffSession
from firmware_protocol.emco.simulator.simulator import EmcoSimulator
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.faults import BrownOut, Fault, Hang, Unplug
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.session import Accepted, Ended, Event, Status, Verdict

SETTINGS = {1: 255, 110: 3000, 111: 3000, 112: 3000, 120: 200, 121: 200, 122: 200}
STROKE = ("G0 X0", "G1 Z0 F1500", "G1 X10 F1500", "G0 Z5")
PROGRAM = (ProgramLine("G0 Z5"), *(ProgramLine(text, stroke) for stroke in range(8) for text in STROKE))


class Unattended(SimulatedTransport):
    """A machine whose daemon is busy elsewhere for a while, or whose port takes no byte."""

    clogged = False

    def __init__(self, simulator: GrblSimulator) -> None:
        super().__init__(simulator)
        self.held_s: list[float] = []
        """When it was told to hold."""
        self.later: tuple[float, Callable[[], None]] = (float("inf"), lambda: None)
        """What another thread does at a moment, while this one waits."""

    def write(self, data: bytes) -> None:
        if b"!" in data:
            self.held_s.append(self.now())
        if self.clogged:
            raise MachineFault("takes no more bytes")
        super().write(data)

    def _pass_until(self, moment: float | None) -> None:
        at_s, act = self.later
        if at_s <= (moment or 0.0):
            self._now, self.later = max(self._now, at_s), (float("inf"), lambda: None)
            return act()
        return super()._pass_until(moment)

    def pass_s(self, seconds: float) -> None:
        self._now += seconds


class Table:
    """A link to a simulated plotter, and what it has heard."""

    def __init__(self, *faults: Fault, settings: dict[int, float] | None = None) -> None:
        self.simulator = GrblSimulator(settings=SETTINGS | (settings or {}), faults=faults)
        transport = Unattended(self.simulator)
        self.heard: list[Event] = []
        self.on_event: Callable[[Event], None] = lambda event: None
        session = GrblSession(now=transport.now(), lift=("G90 G21", "G0 Z5"))
        self.transport, self.link = transport, Link(transport, session, heard=self._hear)

    def _hear(self, event: Event) -> None:
        self.heard.append(event)
        self.on_event(event)

    @property
    def lines_drawn(self) -> int:
        """Dots not counted: the pen starts on the sheet."""
        return sum(len(line) > 1 for line in self.simulator.ink)

    def when(self, wanted: Event | type[Event], act: Callable[[], None]) -> None:
        """Do something once, at the first such event."""

        def look(event: Event) -> None:
            if event == wanted or (isinstance(wanted, type) and isinstance(event, wanted)):
                self.on_event = lambda event: None
                act()

        self.on_event = look


def in_another_thread(act: Callable[[], None]) -> Callable[[], None]:
    def run() -> None:
        thread = threading.Thread(target=act)
        thread.start()
        thread.join()

    return run


def interrupt() -> None:
    raise KeyboardInterrupt


def test_connects_and_draws_and_hears_every_event_in_order() -> None:
    table = Table()
    ready = table.link.connect()
    ended = table.link.draw(PROGRAM)
    assert (ready.firmware, ended.verdict) == ("Grbl 1.1h.20190825", Verdict.FINISHED)
    accepted = [event.line for event in table.heard if isinstance(event, Accepted)]
    assert accepted == list(range(len(PROGRAM)))
    assert (table.heard[-1], table.lines_drawn) == (ended, 8)


def test_a_second_job_follows_on_the_same_link() -> None:
    table = Table()
    table.link.connect()
    assert [table.link.draw(PROGRAM).verdict for _ in range(2)] == [Verdict.FINISHED] * 2


def test_a_locked_controller_is_no_machine_and_the_port_is_named() -> None:
    table = Table(settings={22: 1})
    with pytest.raises(NoMachine, match="sim://grbl: the controller is locked"):
        table.link.connect()


def test_a_dead_port_is_no_machine() -> None:
    with pytest.raises(NoMachine, match="nothing answered within 6 s"):
        Table(Hang(at_s=0.0)).link.connect()


def test_a_stop_from_another_thread_ends_the_job_with_the_pen_up() -> None:
    table = Table()
    table.link.connect()
    table.when(Accepted(7), in_another_thread(table.link.stop))
    ended = table.link.draw(PROGRAM)
    assert (ended.verdict, ended.pen_lifted) == (Verdict.STOPPED, True)
    assert table.simulator.position_mm[2] == pytest.approx(5.0)


@pytest.mark.parametrize("after_s", [0.05, 0.3, 0.777, 1.5, 3.0])
def test_a_stop_holds_the_machine_within_a_tenth_of_a_second_on_its_own_clock(after_s: float) -> None:
    table = Table()
    table.link.connect()
    asked_s = table.transport.now() + after_s
    table.transport.later = (asked_s, table.link.stop)
    assert table.link.draw(PROGRAM).verdict is Verdict.STOPPED
    assert 0 <= table.transport.held_s[0] - asked_s <= 0.1


def test_a_stop_asked_for_before_the_job_is_obeyed_and_then_forgotten() -> None:
    table = Table()
    table.link.connect()
    table.link.stop()
    assert table.link.draw(PROGRAM).verdict is Verdict.STOPPED
    assert not [event for event in table.heard if isinstance(event, Accepted)]
    assert table.link.draw(PROGRAM).verdict is Verdict.FINISHED


def test_a_stop_while_connecting_gives_up() -> None:
    table = Table(Hang(at_s=0.0))
    table.link.stop()
    with pytest.raises(NoMachine, match="stopped before the machine answered"):
        table.link.connect()


def test_an_interrupted_job_lifts_the_pen_before_it_is_given_up() -> None:
    table = Table()
    table.link.connect()
    table.when(Accepted(7), interrupt)
    with pytest.raises(KeyboardInterrupt):
        table.link.draw(PROGRAM)
    assert table.simulator.position_mm[2] == pytest.approx(5.0)
    assert isinstance(table.heard[-1], Ended)


def test_an_interrupt_at_the_very_end_does_not_wait_for_ever() -> None:
    table = Table()
    table.link.connect()
    table.when(Ended, interrupt)
    with pytest.raises(MachineFault, match="did not lift the pen in time"):
        table.link.draw(PROGRAM)


def test_an_unplugged_machine_is_an_end_of_the_job() -> None:
    table = Table(Unplug(after_acks=12))
    table.link.connect()
    ended = table.link.draw(PROGRAM)
    assert (ended.verdict, table.heard[-1]) == (Verdict.UNPLUGGED, ended)


def test_a_port_that_takes_no_byte_is_an_end_of_the_job() -> None:
    table = Table()
    table.link.connect()
    table.transport.clogged = True
    assert table.link.draw(PROGRAM).verdict is Verdict.UNPLUGGED


def test_a_job_that_cannot_be_sent_is_a_fault_that_names_the_line() -> None:
    table = Table()
    table.link.connect()
    with pytest.raises(MachineFault, match="sim://grbl: line 1 "):
        table.link.draw([ProgramLine("G1 (one)")])
    assert table.link.draw(PROGRAM).verdict is Verdict.FINISHED


def test_a_job_on_a_controller_that_is_not_ready_is_a_fault() -> None:
    with pytest.raises(MachineFault, match="wait for Ready"):
        Table().link.draw(PROGRAM)


def test_listening_ends_at_its_time() -> None:
    table = Table()
    table.link.connect()
    until = table.transport.now() + 3.5
    table.link.listen(until)
    assert table.transport.now() == until


@pytest.mark.parametrize("call", ["wake", "stop"])
def test_listening_for_ever_is_ended_from_another_thread(call: str) -> None:
    table = Table()
    table.link.connect()
    table.when(Status, in_another_thread(getattr(table.link, call)))
    table.link.listen(None)
    assert table.link.draw(PROGRAM).verdict is Verdict.FINISHED


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [(BrownOut(at_s=5.0), "restarted"), (Hang(at_s=5.0), "not answered"), (Unplug(at_s=5.0), "unplugged")],
)
def test_listening_notices_what_happens_between_jobs(fault: Fault, sentence: str) -> None:
    table = Table(fault)
    table.link.connect()
    with pytest.raises(MachineFault, match=sentence):
        table.link.listen(60.0)


def test_nobody_listening_for_a_while_is_not_the_silence_of_the_machine() -> None:
    table = Table()
    table.link.connect()
    table.transport.pass_s(60.0)
    table.link.listen(table.transport.now())
    assert isinstance(table.heard[-1], Status)


def seconds_at(percent: int) -> float:
    """How long the program takes when another thread wants so many percent after its fourth line."""
    table = Table()
    table.link.connect()
    table.when(Accepted(3), in_another_thread(lambda: table.link.feed(percent)))
    begun_s = table.transport.now()
    assert table.link.draw(PROGRAM).verdict is Verdict.FINISHED
    return table.transport.now() - begun_s


def test_the_feeds_are_overridden_in_the_middle_of_a_drawing() -> None:
    usual_s = seconds_at(100)
    assert seconds_at(200) < usual_s - 0.5
    assert seconds_at(50) > usual_s + 2.0


def test_a_session_without_an_override_is_not_asked_for_one() -> None:
    control = EmcoSimulator()
    transport = SimulatedTransport(control)
    session = XonXoffSession(now=transport.now(), bytes_per_s=960.0, times=lambda lines: [0.0 for _ in lines])
    with pytest.raises(LinedrawError, match="cannot be made faster or slower"):
        Link(transport, session, heard=lambda event: None).feed(80)
