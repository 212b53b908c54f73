"""What a daemon writes: a minute without work, and for each drawing on a card that wears out."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from tests.benchmarks.latency import daemon, drawing, drop, over
from tests.benchmarks.memory import children, idle_share
from tests.benchmarks.wire import served
from tests.torture.rig import await_

DRAWINGS = 5
_IDLE_S = 60.0
_WITHIN_S = 600.0


def show() -> None:
    """Print bytes and calls that write, of daemon and worker."""
    with (
        tempfile.TemporaryDirectory(dir=Path.cwd()) as name,
        served(Path(name) / "grbl"),
        daemon(Path(name)) as process,
    ):
        journal = Path(name) / "state" / "journal.sqlite"
        drop(journal.parent / "inbox", 0, drawing())
        await_("a picture is drawn", lambda: over(journal) == 1, within_s=_WITHIN_S)
        time.sleep(5)
        before, share = written(process.pid), idle_share(process.pid)
        time.sleep(_IDLE_S - 20)
        idle = written(process.pid) - before
        print(f"idle: {share:.2%} of a core, {idle} bytes written to the disk in {_IDLE_S:.0f} s")
        before = written(process.pid)
        for number in range(1, DRAWINGS + 1):
            drop(journal.parent / "inbox", number, drawing())
        await_("all are drawn", lambda: over(journal) == 1 + DRAWINGS, within_s=_WITHIN_S)
        print(f"{(written(process.pid) - before) / DRAWINGS / 1000:.0f} kB written to the disk a drawing")


def written(pid: int) -> int:
    """Bytes that the daemon and its worker have sent to the disk so far."""
    return sum(_written_by(each) for each in (pid, *children(pid)))


def _written_by(pid: int) -> int:
    fields = dict(line.split(": ") for line in Path(f"/proc/{pid}/io").read_text().splitlines())
    return int(fields["write_bytes"])
