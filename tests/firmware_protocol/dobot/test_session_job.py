"""A job that runs to its end, is paused or is stopped."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot.packet import PacketReader
from firmware_protocol.dobot.simulator.arm import Build
from firmware_protocol.dobot.states import State
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.ink import Polyline
from firmware_protocol.session import Accepted, Paused, Resumed, Status, Verdict
from tests.firmware_protocol.dobot.bench import Bench, Line, stroke, strokes


def ids(bench: Bench, since: float) -> list[int]:
    packets = PacketReader().feed(b"".join(data for at, data in bench.sent if at >= since))
    return [packet.id for packet in packets]


def rounded(ink: list[Polyline]) -> list[Polyline]:
    return [[(round(x, 3), round(y, 3)) for x, y in line] for line in ink]


def whole(count: int, **options: float) -> list[Polyline]:
    """The ink of `strokes` on an arm that does everything right."""
    bench = Bench()
    bench.draw(strokes(count, **options))  # type: ignore[arg-type]
    return rounded(bench.sim.ink)


def test_everything_is_on_the_paper_when_it_says_finished() -> None:
    bench = Bench()
    end = bench.draw(strokes(3))
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.FINISHED, 3, 3)
    assert (end.position_known, end.pen_lifted) == (True, True)
    expected = [[(200.0 + 4 * k, -20.0 + 5 * n) for k in range(11)] for n in range(3)]
    assert rounded(bench.sim.ink) == expected
    assert bench.sim.next_time() is None or bench.sim.arm.left == 32
    assert bench.all_of(Accepted) == [Accepted(line) for line in range(len(strokes(3)))]


@pytest.mark.parametrize(
    "build",
    [
        Build(depth=3),
        Build(depth=500),
        Build(first_index=2),
        Build(clear_resets=True),
        Build(left_holds_running=False),
        Build(unused=0xFFFFFFFFFFFFFFFF),
    ],
    ids=str,
)
def test_every_build_of_an_arm_draws_the_same(build: Build) -> None:
    bench = Bench(arm={"build": build})
    assert bench.draw(strokes(3)).verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink) == whole(3)


def test_a_second_job_is_drawn_like_the_first() -> None:
    bench = Bench()
    bench.draw(strokes(2))
    bench.events.clear()
    bench.start(strokes(3))
    bench.until(lambda: bench.over)
    assert bench.ended.verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink)[2:] == whole(3)


def test_the_queue_is_never_filled_to_the_brim_and_never_empty_in_a_stroke() -> None:
    bench = Bench().ready().start(strokes(2, segments=200, step_mm=0.4))
    most = 0
    while not bench.over:
        most = max(most, bench.sim.arm.build.depth - bench.sim.arm.left)
        bench.turn(bench.now + 1)
    assert most == 30
    assert bench.sim.arm.waited_on_paper_s == 0.0


@pytest.mark.parametrize("late_s", [0.001, 0.004])
def test_the_pen_does_not_wait_on_the_paper_for_a_busy_host(late_s: float) -> None:
    """Segments of 1 mm at 50 mm/s: 50 commands a second, each looked at late."""
    bench = Bench(late_s=late_s)
    bench.draw(strokes(2, segments=80, step_mm=1.0))
    assert bench.sim.arm.waited_on_paper_s == 0.0


def test_a_host_that_is_away_for_half_a_second_leaves_the_pen_moving() -> None:
    bench = Bench().ready().start(strokes(1, segments=80, step_mm=1.0))
    bench.until(lambda: not bench.sim.arm.left > 2)
    bench.sim.advance(bench.now + 0.5)
    bench.now += 0.5
    bench.until(lambda: bench.over)
    assert bench.sim.arm.waited_on_paper_s == 0.0


def test_where_the_pen_is_is_told_from_the_sheets_corner() -> None:
    bench = Bench(sheet_origin_mm=(190.0, -57.0))
    bench.draw(strokes(1))
    places = [status.position_mm for status in bench.all_of(Status)]
    assert places
    assert all(5.0 <= x <= 60.0 and 30.0 <= y <= 60.0 for x, y, _ in places)


@pytest.mark.parametrize("after_s", [0.0, 0.3, 1.0, 2.0, 3.3])
def test_a_stop_aborts_clears_starts_and_lifts(after_s: float) -> None:
    bench = Bench().ready().start(strokes(4))
    bench.wait(after_s)
    bench.session.stop(bench.now)
    asked = bench.now
    bench.until(lambda: bench.over)
    end = bench.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.STOPPED, True, True)
    assert bench.now - asked < 1.0
    sent = ids(bench, asked)
    assert sent[sent.index(242) :][:5] == [242, 245, 246, 10, 240]
    assert bench.sim.arm.place[2] >= 10.0
    bench.drain()
    complete = sum(line == full for line, full in zip(rounded(bench.sim.ink), whole(4), strict=False))
    assert end.strokes_certain <= complete <= len(bench.sim.ink) <= end.strokes_possible <= end.strokes_certain + 2


def test_after_a_stop_the_next_job_is_drawn() -> None:
    bench = Bench().ready().start(strokes(4))
    bench.wait(1.0)
    bench.session.stop(bench.now)
    bench.until(lambda: bench.over)
    bench.events.clear()
    before = len(bench.sim.ink)
    bench.start(strokes(2))
    bench.until(lambda: bench.over)
    assert bench.ended.verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink)[before:] == whole(2)


def test_a_stop_without_a_job_changes_nothing() -> None:
    bench = Bench().ready()
    bench.session.stop(bench.now)
    assert bench.session.state is State.READY


@pytest.mark.parametrize("after_s", [0.0, 0.2, 0.9, 1.7])
def test_a_pause_stands_at_the_end_of_a_stroke_and_goes_on(after_s: float) -> None:
    bench = Bench().ready().start(strokes(12))
    bench.wait(after_s)
    bench.session.pause(bench.now)
    bench.until(lambda: bench.session.state is State.PAUSED)
    (paused,) = bench.all_of(Paused)
    assert paused.at_mm is None
    assert paused.stroke == len(bench.sim.ink)
    assert bench.sim.arm.place[2] >= 10.0
    bench.wait(3.0)
    bench.session.resume(bench.now)
    bench.until(lambda: bench.over)
    assert bench.ended.verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink) == whole(12)
    assert bench.all_of(Resumed) == [Resumed()]


@pytest.mark.parametrize("abort_counts", [False, True])
@pytest.mark.parametrize("after_s", [0.02, 0.5, 0.9, 1.234, 1.7, 2.2])
def test_a_pause_at_once_takes_the_stroke_up_where_it_was_cut(after_s: float, abort_counts: bool) -> None:
    bench = Bench(arm={"build": Build(abort_counts=abort_counts)}).ready().start(strokes(3))
    bench.wait(after_s)
    bench.session.pause(bench.now, at_once=True)
    bench.until(lambda: bench.session.state is State.PAUSED)
    (paused,) = bench.all_of(Paused)
    assert paused.at_mm is not None
    assert bench.sim.arm.place[2] >= 10.0
    bench.session.resume(bench.now)
    bench.until(lambda: bench.over)
    assert bench.ended.verdict is Verdict.FINISHED
    drawn = sorted({point for line in rounded(bench.sim.ink) for point in line})
    wanted = sorted({point for line in whole(3) for point in line})
    assert set(wanted) <= set(drawn)
    assert all(y in {-20.0, -15.0, -10.0} and 200.0 <= x <= 240.0 for x, y in drawn)


def test_a_pause_can_be_stopped_and_resuming_needs_one() -> None:
    bench = Bench().ready().start(strokes(6))
    with pytest.raises(LocalProtocolError, match="pause it first"):
        bench.session.resume(bench.now)
    bench.session.pause(bench.now)
    bench.until(lambda: bench.session.state is State.PAUSED)
    drawn = len(bench.sim.ink)
    bench.session.stop(bench.now)
    bench.until(lambda: bench.over)
    end = bench.ended
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.STOPPED, drawn, drawn)


def test_a_wait_in_a_job_is_no_standstill() -> None:
    bench = Bench()
    end = bench.draw([*stroke(0, (200, 0), (220, 0)), Line("WAIT 8000"), *stroke(1, (200, 10), (220, 10))])
    assert end.verdict is Verdict.FINISHED
    assert bench.now > 8.0


def test_an_arm_can_home_within_a_job() -> None:
    bench = Bench(arm={"build": Build(home_s=20.0)})
    assert bench.draw([Line("HOME 0"), *stroke(0, (200, 0), (220, 0))]).verdict is Verdict.FINISHED
