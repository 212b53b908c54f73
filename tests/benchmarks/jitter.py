"""How late the daemon sends the next line after an answer: with nothing else to do, and while its worker plans.

Line by line (`flow = "line"`), so that every answer asks for a line at once; a simulated plotter behind a pseudo
terminal in real time. The simulator lives in this process and takes a part of the same processors.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

from daemon.shapes import Grey
from tests.benchmarks.latency import busy_s, daemon, drop
from tests.benchmarks.sheets import sheet
from tests.benchmarks.wire import Wire, served
from tests.torture.rig import await_

BAR_MS = 20.0
_WATCHED_S = 100.0
"""Some thousands of lines: of fewer the slowest thousandth is one or two."""
_PLANNED = 2
_SIDE_PX = 1000
_MORE = """flow = "line"
[sheet]
error_mm = 0.01
"""
_BEGINS_WITHIN_S = 120.0


def show() -> None:
    """Print the percentiles of both."""
    print(f"answer to next line, ms, bar {BAR_MS:g} at 99.9 %")
    print(f"{'':18}{'lines':>8}{'50 %':>8}{'99 %':>8}{'99.9 %':>8}{'most':>8}")
    with (
        tempfile.TemporaryDirectory() as name,
        served(Path(name) / "grbl") as wire,
        daemon(Path(name), more=_MORE) as process,
    ):
        inbox = Path(name) / "state" / "inbox"
        wire.await_line()
        drop(inbox, 0, waves())
        await_("a line comes", lambda: wire.line_at_s is not None, within_s=_BEGINS_WITHIN_S)
        row("nothing planned", watched(wire))
        for number in range(1, _PLANNED + 1):
            drop(inbox, number, sheet(8.0, 0.3))
        before_s = busy_s(process.pid)
        row("worker at work", watched(wire))
        print(f"daemon and worker took {(busy_s(process.pid) - before_s) / _WATCHED_S:.0%} of a core meanwhile")


def waves() -> Grey:
    """Long lines of short bends: many lines of a program, few lifts of the pen."""
    grey, x = np.full((_SIDE_PX, _SIDE_PX), 255, np.uint8), np.arange(20.0, _SIDE_PX - 20)
    for y in range(25, _SIDE_PX - 20, 15):
        line = np.stack([x, y + 5 * np.sin(x / 6)], axis=1)
        cv2.polylines(grey, [np.rint(line * 16).astype(np.int32)], False, 0, 2, cv2.LINE_AA, 4)
    return grey


def watched(wire: Wire) -> list[float]:
    """How late lines were in the seconds that follow."""
    wire.late_s.clear()
    time.sleep(_WATCHED_S)
    return list(wire.late_s)


def row(name: str, late_s: list[float]) -> None:
    if not late_s:
        raise SystemExit(f"no line was sent in {_WATCHED_S:g} s: run make demo")
    figures = np.percentile(1000 * np.array(late_s), [50, 99, 99.9, 100])
    print(f"{name:18}{len(late_s):>8}" + "".join(f"{each:>8.2f}" for each in figures), flush=True)
