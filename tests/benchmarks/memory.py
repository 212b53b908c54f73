"""Peak resident memory of the daemon and of its worker while they draw pages of 256, 512 and 1024 px."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import cv2

from daemon.config import Options, load_settings
from tests.benchmarks.pages import SIDES_PX, page
from tests.demo import OVER, daemon, drop, seen_jobs

_GIVE_UP_S = 300.0


def show() -> None:
    """Print a line for each page; the worker stays warm, so each line includes what the pages before have left."""
    print("peak resident memory, MB")
    print(f"{'':12}{'daemon':>9}{'worker':>9}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "state").mkdir()
        settings = load_settings(Options(device="sim", state_dir=folder / "state"))
        with daemon(folder) as process:
            for count, side_px in enumerate(SIDES_PX, start=1):
                picture = folder / f"page-{side_px}.png"
                cv2.imwrite(str(picture), page(side_px))
                drop([picture], settings.paths.inbox)
                worker_mb = watched(settings.paths.journal, count, process.pid)
                print(f"{side_px:>9} px{peak_mb(process.pid):>9.0f}{worker_mb:>9.0f}", flush=True)


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
