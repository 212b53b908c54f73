"""Draw for long: `python -m tests.soak [--hours 72] [--drawings 5000]`, whichever is reached last.

Hours are those of the simulated machine. Prints memory, open files and the size of the log after a tenth and at the
end; exit code 1 when the memory has grown by 10 MB or more, or files were left open.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from random import Random

from tests.torture.pictures import draw_picture
from tests.torture.rig import await_
from tests.torture.told import told

GROWTH_MB = 10.0
AT_WORK = 4
"""Files that are open for a moment, such as a job's log."""
WAITING = 4
BEGINS_WITHIN_S = 60.0
_TOML = """
[intake]
settle_s = 0.02
[machines.plotter]
device = "grbl"
url = "sim://grbl"
"""


@dataclass(frozen=True, slots=True)
class Figures:
    """Of the daemon at one moment."""

    drawings: int
    hours: float
    memory_mb: float
    files: int
    log_kb: float

    def __str__(self) -> str:
        return (
            f"{self.drawings:>6} drawings {self.hours:8.2f} h   daemon {self.memory_mb:6.1f} MB   "
            f"{self.files:>3} files open   log {self.log_kb:8.0f} kB"
        )


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__.splitlines()[0])
    parser.add_argument("--hours", type=float, default=72.0)
    parser.add_argument("--drawings", type=int, default=5000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="soak-") as folder:
        early, late = soaked(Path(folder), options.hours, options.drawings)
    grown_mb = late.memory_mb - early.memory_mb
    log_bytes = 1000 * (late.log_kb - early.log_kb) / max(1, late.drawings - early.drawings)
    opened = late.files - early.files
    print(f"memory grew by {grown_mb:.1f} MB, open files by {opened}, the log by {log_bytes:.0f} bytes a drawing")
    return 1 if grown_mb >= GROWTH_MB or opened > AT_WORK else 0


def soaked(folder: Path, hours: float, drawings: int) -> tuple[Figures, Figures]:
    """The figures after a tenth of it and at its end."""
    state, config = folder / "state", folder / "linedrawd.toml"
    (state / "inbox").mkdir(parents=True)
    config.write_text(_TOML)
    command = [sys.executable, "-m", "tests.torture.daemon", config, state]
    process = subprocess.Popen(command)
    try:
        await_("the daemon runs", (state / "run" / "status.json").exists, within_s=BEGINS_WITHIN_S)
        return _drawn_on(state, process, hours, drawings)
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait()


def _drawn_on(state: Path, process: subprocess.Popen[bytes], hours: float, drawings: int) -> tuple[Figures, Figures]:
    early: Figures | None = None
    dropped, shown, drawn_s = 0, -1, {}
    while True:
        over = [job.id for job in told(state / "journal.sqlite").values() if job.over]
        for job in over[len(drawn_s) :]:
            drawn_s[job] = _real_s(state / "jobs" / job)
        now = _figures(state, process.pid, len(over), sum(drawn_s.values()) / 3600)
        share = min(now.drawings / drawings, now.hours / hours)
        if int(share * 10) > shown:
            shown = int(share * 10)
            print(now, flush=True)
        early = now if early is None and share >= 0.1 else early
        if share >= 1:
            return early or now, now
        while dropped - len(over) < WAITING:
            dropped += 1
            _drop(state / "inbox", dropped)
        if process.poll() is not None:
            raise SystemExit(f"the daemon has ended with code {process.returncode} after {len(over)} drawings")
        time.sleep(0.2)


def _drop(inbox: Path, number: int) -> None:
    part = inbox / f".{number}.png"
    draw_picture(part, Random(number))
    part.rename(inbox / f"{number}.png")


def _real_s(folder: Path) -> float:
    return float(json.loads((folder / "report.json").read_text()).get("real_s") or 0.0)


def _figures(state: Path, pid: int, drawings: int, hours: float) -> Figures:
    status = Path(f"/proc/{pid}/status").read_text()
    memory_mb = next(int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmRSS"))
    log_kb = sum(path.stat().st_size for path in (state / "log").iterdir()) / 1000
    return Figures(drawings, hours, memory_mb, len(os.listdir(f"/proc/{pid}/fd")), log_kb)


if __name__ == "__main__":
    sys.exit(main())
