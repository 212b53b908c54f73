"""From the claim of a picture to the first draw move of its program on the wire.

The daemon as it is started, a worker that is warm, a simulated plotter behind a pseudo terminal in real time.
"""

from __future__ import annotations

import signal
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

import cv2
import numpy as np

from daemon.shapes import Grey
from tests.benchmarks.memory import children, cpu_s
from tests.benchmarks.pages import sketch
from tests.benchmarks.wire import Wire, served
from tests.torture.rig import await_

ROUNDS = 5
BAR_S = 0.8
_SIDE_PX = 1000
_READY_WITHIN_S, _DRAWN_WITHIN_S = 60.0, 120.0
_TOML = """
[intake]
settle_s = 0.02
[machines.plotter]
device = "grbl"
url = "serial://{port}"
draw_mm_s = 150
sheet = "feed"
"""


def show() -> None:
    """Print the seconds of each round, and the CPU seconds of daemon and worker in them."""
    print(f"a line drawing of {_SIDE_PX} x {_SIDE_PX} px, claimed: s to its first line on the wire, bar {BAR_S:g} s")
    with tempfile.TemporaryDirectory() as name, served(Path(name) / "grbl") as wire, daemon(Path(name)) as process:
        rounds = [one(Path(name), number, wire, process.pid) for number in range(ROUNDS + 1)]
    print(f"first, cold worker  {rounds[0][0]:6.2f} s  {rounds[0][1]:6.2f} CPU s")
    for wall_s, busy_s in sorted(rounds[1:]):
        print(f"warm worker         {wall_s:6.2f} s  {busy_s:6.2f} CPU s")


@contextmanager
def daemon(folder: Path, *, more: str = "", under: Sequence[str] = ()) -> Iterator[subprocess.Popen[bytes]]:
    """`linedrawd` on the plotter at `grbl` in the folder, until SIGTERM.

    more: settings of the plotter. under: a command that becomes the one behind it.
    """
    config, state = folder / "linedrawd.toml", folder / "state"
    (state / "inbox").mkdir(parents=True)
    config.write_text(_TOML.format(port=folder / "grbl") + more)
    linedrawd = Path(sys.executable).with_name("linedrawd")
    with (folder / "said.txt").open("wb") as said:
        process = subprocess.Popen(
            [*under, linedrawd, "--config", config, "--state-dir", state], stdout=said, stderr=subprocess.STDOUT
        )
    try:
        await_("the daemon runs", (state / "run" / "status.json").exists, within_s=_READY_WITHIN_S)
        yield process
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(30)


def one(folder: Path, number: int, wire: Wire, pid: int) -> tuple[float, float]:
    """Drop a drawing; the seconds from its claim to the first draw move on the wire, and the CPU seconds in them."""
    journal = folder / "state" / "journal.sqlite"
    await_("the plotter rests", lambda: over(journal) == number, within_s=_DRAWN_WITHIN_S)
    before_s = busy_s(pid)
    wire.await_line()
    drop(folder / "state" / "inbox", number, drawing())
    await_("a line comes", lambda: wire.line_at_s is not None, within_s=_DRAWN_WITHIN_S)
    took = busy_s(pid) - before_s
    assert wire.line_at_s is not None
    return wire.line_at_s - claimed_at_s(journal), took


def drop(inbox: Path, number: int, grey: Grey) -> None:
    """Put the picture into the inbox, whole at once."""
    part = inbox / f".{number}.png"
    cv2.imwrite(str(part), grey)
    part.rename(inbox / f"{number}.png")


def drawing() -> Grey:
    """The sketch once, as large as the page, with a line of 3 px."""
    grey = np.full((_SIDE_PX, _SIDE_PX), 255, np.uint8)
    lines = [np.rint(stroke * _SIDE_PX / 256 * 16).astype(np.int32) for stroke in sketch()]
    cv2.polylines(grey, lines, False, 0, 2, cv2.LINE_AA, 4)
    return grey


def busy_s(pid: int) -> float:
    """CPU seconds of the daemon and its workers so far."""
    return sum(cpu_s(each) for each in (pid, *children(pid)))


def over(journal: Path) -> int:
    """How many jobs are done."""
    with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True)) as rows:
        return int(rows.execute("SELECT count(*) FROM events WHERE job <> '' AND state = 'done'").fetchone()[0])


def claimed_at_s(journal: Path) -> float:
    """When the last job came, on the clock of the wall."""
    with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True)) as rows:
        found = rows.execute("SELECT max(at_s) FROM events WHERE job <> '' AND state = 'queued'").fetchone()
    return float(found[0])
