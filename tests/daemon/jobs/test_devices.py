"""What the settings of a machine mean."""

from __future__ import annotations

import pytest

from daemon.config import DobotMachine, EmcoMachine, GrblMachine
from daemon.errors import LinedrawError
from daemon.jobs import emco
from daemon.jobs.devices import opened, program_of, seconds_of
from daemon.jobs.grbl import moved
from firmware_protocol.session import Ended
from tests.daemon.program.examples import TOOLPATH


def test_a_machine_that_homes_before_each_job_has_it_in_its_program() -> None:
    plain, homed = (program_of(TOOLPATH, GrblMachine(home=home), "cat.png") for home in ("never", "job"))  # type: ignore[arg-type]
    assert [line.text for line in homed.lines] == ["$H", *(line.text for line in plain.lines)]
    assert seconds_of(homed, GrblMachine(home="job")) == seconds_of(plain, GrblMachine()) > 0


@pytest.mark.parametrize(
    ("line", "elsewhere"),
    [
        ("G0 X1.000 Y-2.500", "G0 X11.000 Y-7.500"),
        ("X3 Y4", "X13.000 Y-1.000"),
        ("G1 Z0.000 F600", "G1 Z0.000 F600"),
        ("G91 G0 X1.000 Y1.000", "G91 G0 X1.000 Y1.000"),
        ("M3 S650", "M3 S650"),
    ],
)
def test_a_displaced_line_has_other_places_and_nothing_else(line: str, elsewhere: str) -> None:
    assert moved(line, (10.0, -5.0)) == elsewhere


def ended_unheard(machine: EmcoMachine) -> tuple[int, Ended | None]:
    """A program for a control that never says a word: the longest piece that was written, and the end within 10 s."""
    session = emco.conversation(machine, still=False).session(0.0)
    session.start(program_of(TOOLPATH, machine, "000001-example").lines, 0.0)
    longest, now = 0, 0.0
    while now < 10.0:
        longest = max(longest, len(session.data_to_send(now)))
        ends = [event for event in session.expire(now) if isinstance(event, Ended)]
        if ends:
            return longest, ends[0]
        now = max(now + 0.001, session.deadline() or now + 1.0)
    return longest, None


def test_how_much_a_control_can_hold_is_a_setting() -> None:
    plain = EmcoMachine(device="emco", url="serial:///dev/ttyS0", wait_for_xon=False)
    assert ended_unheard(plain) == (16, None)
    longest, end = ended_unheard(plain.model_copy(update={"chunk_bytes": 8, "holds_bytes": 20}))
    assert longest == 8
    assert end is not None
    assert "holds 20 at most" in end.why


@pytest.mark.parametrize(
    ("machine", "instead"),
    [
        (EmcoMachine(device="emco", url="sim://emco"), "turn the operator's override switch"),
        (DobotMachine(device="dobot", url="sim://dobot"), "set another draw_mm_s"),
    ],
)
def test_a_machine_whose_feed_stays_says_what_to_do_instead(machine: EmcoMachine | DobotMachine, instead: str) -> None:
    way = opened(machine, lambda event: None, True)
    with pytest.raises(LinedrawError, match=instead):
        way.feed(80)
