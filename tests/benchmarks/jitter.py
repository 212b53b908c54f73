"""How late the daemon sends the next line after an answer: with nothing else to do, and while its worker plans.

Line by line (`flow = "line"`), so that every answer asks for a line at once; a simulated plotter behind a pseudo
terminal in real time. The simulator lives in this process and takes a part of the same processors. Meanwhile it counts
how often its planner ran dry, and strace, where it is installed, what the daemon, without its worker, has the disk
make durable.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np

from daemon.control import Order, give_order
from daemon.shapes import Grey
from tests.benchmarks.latency import busy_s, daemon, drop
from tests.benchmarks.sheets import sheet
from tests.benchmarks.wire import Wire, served
from tests.torture.rig import await_

BAR_MS = 20.0
FSYNCS_BAR = 2.0
"""A second, while it draws."""
STOP_BAR_MS = 100.0
_SETTLES_S = 5.0
"""Until the worker is at work, and while the drawing goes on in any case."""
_WATCHED_S = 100.0
"""Some thousands of lines: of fewer the slowest thousandth is one or two."""
_PLANNED = 2
_SIDE_PX = 1000
_LINE_BY_LINE = 'flow = "line"\n'
_FINE = """[sheet]
error_mm = 0.01
"""
_BEGINS_WITHIN_S = 120.0


def show() -> None:
    """Print the percentiles of both, and what comes of them where lines are sent ahead, as they are by default."""
    print(f"answer to next line, ms, bar {BAR_MS:g} at 99.9 %; bars of fsyncs {FSYNCS_BAR:g} a second, of dry 0")
    print(
        f"{'':18}{'lines':>8}{'50 %':>8}{'99 %':>8}{'99.9 %':>8}{'most':>8}{'fsyncs/s':>10}{'dry':>6}{'of a core':>11}"
    )
    with drawing(_LINE_BY_LINE + _FINE) as (watched, inbox):
        watched.row("nothing planned")
        plan(inbox)
        watched.row("worker at work")
    with drawing(_FINE) as (watched, inbox):
        plan(inbox)
        watched.row("sent ahead")
    with drawing(_FINE) as (watched, inbox):
        plan(inbox)
        time.sleep(_SETTLES_S)
        held_ms = 1000 * watched.stop(inbox.parent / "run" / "control.sock")
        print(f"an order to stop came to the controller as a feed hold within {held_ms:.0f} ms, bar {STOP_BAR_MS:g} ms")


@contextmanager
def drawing(more: str) -> Iterator[tuple[Watched, Path]]:
    """A daemon with these settings that draws `waves`, and its inbox."""
    with (
        tempfile.TemporaryDirectory() as name,
        served(Path(name) / "grbl") as wire,
        daemon(Path(name), more=more, under=counting(Path(name) / "fsyncs.txt")) as process,
    ):
        inbox = Path(name) / "state" / "inbox"
        wire.await_line()
        drop(inbox, 0, waves())
        await_("a line comes", lambda: wire.line_at_s is not None, within_s=_BEGINS_WITHIN_S)
        yield Watched(wire, Path(name) / "fsyncs.txt", process.pid), inbox


def plan(inbox: Path) -> None:
    """Give the worker something to do, for longer than is watched."""
    for number in range(1, _PLANNED + 1):
        drop(inbox, number, sheet(8.0, 0.3))


def waves() -> Grey:
    """Long lines of short bends: many lines of a program, few lifts of the pen."""
    grey, x = np.full((_SIDE_PX, _SIDE_PX), 255, np.uint8), np.arange(20.0, _SIDE_PX - 20)
    for y in range(25, _SIDE_PX - 20, 15):
        line = np.stack([x, y + 5 * np.sin(x / 6)], axis=1)
        cv2.polylines(grey, [np.rint(line * 16).astype(np.int32)], False, 0, 2, cv2.LINE_AA, 4)
    return grey


def counting(told: Path) -> list[str]:
    """The command under which the daemon's fsyncs are written to this file; [] where strace is not installed."""
    strace = shutil.which("strace")
    return [strace, "-D", "-f", "--seccomp-bpf", "-o", str(told), "-e", "fsync,fdatasync"] if strace else []


class Watched:
    """The seconds that follow, in one row each time. told: the file of `counting`. pid: of the daemon."""

    def __init__(self, wire: Wire, told: Path, pid: int) -> None:
        self._wire, self._told, self._pid = wire, told, pid

    def row(self, name: str) -> None:
        dry, fsyncs, before_s = self._wire.dry, self._fsyncs(), busy_s(self._pid)
        self._wire.late_s.clear()
        time.sleep(_WATCHED_S)
        late_s = list(self._wire.late_s)
        if not late_s:
            raise SystemExit(f"no line was sent in {_WATCHED_S:g} s: run make demo")
        figures = np.percentile(1000 * np.array(late_s), [50, 99, 99.9, 100])
        a_second = f"{(self._fsyncs() - fsyncs) / _WATCHED_S:.2f}" if self._told.exists() else "?"
        late, busy = "".join(f"{each:>8.2f}" for each in figures), (busy_s(self._pid) - before_s) / _WATCHED_S
        print(f"{name:18}{len(late_s):>8}{late}{a_second:>10}{self._wire.dry - dry:>6}{busy:>11.0%}", flush=True)

    def stop(self, control: Path) -> float:
        """Seconds from the order to the feed hold, while something is drawn."""
        asked_s = time.monotonic()
        give_order(control, Order(order="stop"))
        await_("it holds", lambda: self._wire.held_at_s is not None, within_s=_BEGINS_WITHIN_S)
        assert self._wire.held_at_s is not None
        return self._wire.held_at_s - asked_s

    def _fsyncs(self) -> int:
        """Of the daemon's own threads so far; those of its worker delay no line."""
        if not self._told.exists():
            return 0
        threads = set(os.listdir(f"/proc/{self._pid}/task"))
        called = (line.split() for line in self._told.read_text().splitlines() if "sync(" in line)
        return sum(thread in threads for thread, *_ in called)
