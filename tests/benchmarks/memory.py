"""Peak resident memory of the daemon and its worker while they draw, and what an idle daemon costs."""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

from daemon.config import Options, load_settings
from daemon.jobs.states import OVER
from daemon.shapes import Grey
from tests.benchmarks.pages import SIDES_PX, page, sketch
from tests.demo import daemon, drop, seen_jobs

_GIVE_UP_S = 300.0
_PHOTO_PX = 3200
_IDLE_S = 20.0


def show() -> None:
    """Print a line for each page; the worker stays warm, so each line includes what the pages before have left.

    The last page has ten megapixels, the sketch as a camera sees it. Then the daemon has nothing to do.
    """
    print("peak resident memory, MB")
    print(f"{'':12}{'daemon':>9}{'worker':>9}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "state").mkdir()
        settings = load_settings(Options(device="sim", state_dir=folder / "state"))
        with daemon(folder) as process:
            for count, side_px in enumerate((*SIDES_PX, _PHOTO_PX), start=1):
                picture = folder / f"page-{side_px}.png"
                cv2.imwrite(str(picture), photo() if side_px == _PHOTO_PX else page(side_px))
                drop([picture], settings.paths.inbox)
                worker_mb = watched(settings.paths.journal, count, process.pid)
                print(f"{side_px:>9} px{peak_mb(process.pid):>9.0f}{worker_mb:>9.0f}", flush=True)
            print(f"an idle daemon takes {idle_share(process.pid):.2%} of a core")


def photo() -> Grey:
    """The sketch once, on a page of ten megapixels."""
    grey = np.full((_PHOTO_PX, _PHOTO_PX), 255, np.uint8)
    scale = _PHOTO_PX / 256
    for stroke in sketch():
        cv2.polylines(grey, [np.rint(stroke * scale).astype(np.int32)], False, 0, round(2.4 * scale), cv2.LINE_AA)
    return grey


def idle_share(pid: int) -> float:
    """The share of a core that the process takes while nobody wants anything."""
    before = cpu_s(pid)
    time.sleep(_IDLE_S)
    return (cpu_s(pid) - before) / _IDLE_S


def cpu_s(pid: int) -> float:
    """User and system time of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def watched(journal: Path, count: int, daemon_pid: int) -> float:
    """Wait until that many jobs are over; the peak of the daemon's largest child meanwhile, in MB."""
    largest_mb, give_up = 0.0, time.monotonic() + _GIVE_UP_S
    while sum(job.state in OVER for job in seen_jobs(journal)) < count:
        if time.monotonic() > give_up:
            raise SystemExit(f"the daemon has not drawn {count} pages in {_GIVE_UP_S:.0f} s: run make demo")
        largest_mb = max(largest_mb, *map(peak_mb, children(daemon_pid)), 0.0)
        time.sleep(0.05)
    return largest_mb


def children(pid: int) -> list[int]:
    """The processes whose parent this one is."""
    found = []
    for status in Path("/proc").glob("[0-9]*/status"):
        try:
            if f"PPid:\t{pid}\n" in status.read_text():
                found.append(int(status.parent.name))
        except OSError:
            continue  # It has just ended.
    return found


def peak_mb(pid: int) -> float:
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmHWM")), 0.0)
