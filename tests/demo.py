"""The demo: pictures go through the daemon onto a simulated plotter, and a contact sheet shows what became of them.

    python -m tests.demo FOLDER [PICTURE...]

Everything is written below FOLDER: `state/` (emptied first), `linedrawd.txt` and `contact_sheet.png`.
"""

from __future__ import annotations

import argparse
import json
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from daemon.config import Options, Settings, load_settings
from daemon.errors import LinedrawError
from daemon.homography import through
from daemon.intake.picture import open_picture
from daemon.intake.vector.sheet import VectorPage
from daemon.jobs.folder import source_of
from daemon.jobs.states import OVER, State
from daemon.report import canvas
from daemon.report.contact_sheet import Row, contact_sheet
from daemon.report.preview import in_words
from daemon.report.report import from_json
from daemon.toolpath.place import invert, place

DRAWINGS = Path(__file__).parent / "drawings"
KINDS = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".pbm", ".pgm", ".ppm"}
LOOK_EVERY_S = 0.25


@dataclass(frozen=True, slots=True)
class Seen:
    """What the journal says of one job."""

    id: str
    name: str
    state: State
    words: str


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0 when every picture has been drawn, 1 when one has not."""
    parser = argparse.ArgumentParser(prog="python -m tests.demo", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where everything is written; its state/ is emptied first")
    parser.add_argument("pictures", type=Path, nargs="*", help="pictures to draw (default: tests/drawings)")
    options = parser.parse_args(arguments)
    pictures = options.pictures or sorted(path for path in DRAWINGS.iterdir() if path.suffix.lower() in KINDS)
    shutil.rmtree(options.folder / "state", ignore_errors=True)
    (options.folder / "state").mkdir(parents=True)
    settings = load_settings(Options(device="sim", state_dir=options.folder / "state"))
    with daemon(options.folder) as process:
        drop(pictures, settings.paths.inbox)
        jobs = wait_for(len(pictures), settings, process, options.folder)
    rows = [row_of(settings, job) for job in jobs]
    sheet = options.folder / "contact_sheet.png"
    done = sum(job.state is State.DONE for job in jobs)
    sheet.write_bytes(canvas.png(contact_sheet(rows, title=f"linedrawd: {done} of {len(jobs)} pictures drawn")))
    print(f"{done} of {len(jobs)} pictures drawn, see {sheet}")
    return 0 if done == len(pictures) else 1


@contextmanager
def daemon(folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """`linedrawd --device sim` on the folder, until SIGTERM."""
    command = [
        str(Path(sys.executable).with_name("linedrawd")),
        "--device",
        "sim",
        "--state-dir",
        str(folder / "state"),
    ]
    with (folder / "linedrawd.txt").open("wb") as said:
        process = subprocess.Popen(command, stdout=said, stderr=said)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            raise


def drop(pictures: list[Path], inbox: Path) -> None:
    """Put copies of the pictures into the inbox, each whole at once."""
    inbox.mkdir(parents=True, exist_ok=True)
    for picture in pictures:
        part = inbox / f".{picture.name}.part"
        shutil.copyfile(picture, part)
        part.rename(inbox / picture.name)


def wait_for(count: int, settings: Settings, process: subprocess.Popen[bytes], folder: Path) -> list[Seen]:
    """Say a line for each job that is over, until `count` are. Raises SystemExit when the daemon ends before."""
    told: set[str] = set()
    while True:
        jobs = seen_jobs(settings.paths.journal)
        for job in jobs:
            if job.state in OVER and job.id not in told:
                told.add(job.id)
                say(line_of(settings, job))
        if len(told) >= count:
            return jobs
        if process.poll() is not None:
            raise SystemExit(f"linedrawd ended with code {process.returncode}: see {folder / 'linedrawd.txt'}")
        show_progress(settings.paths.status, len(told), count)
        time.sleep(LOOK_EVERY_S)


def seen_jobs(journal: Path) -> list[Seen]:
    """The jobs in the order in which they came; read without a write, the daemon is at work on it."""
    if not journal.is_file():
        return []
    with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True)) as rows:
        try:
            events = rows.execute("SELECT job, state, words FROM events WHERE job <> '' ORDER BY number").fetchall()
        except sqlite3.OperationalError:
            return []  # The daemon is just making it.
    names: dict[str, str] = {}
    last: dict[str, Seen] = {}
    for job, state, words in events:
        name = names.setdefault(job, words)
        last[job] = Seen(job, name, State(state), words)
    return list(last.values())


def say(line: str) -> None:
    print(f"\r\x1b[K{line}" if sys.stdout.isatty() else line, flush=True)


def show_progress(status: Path, over: int, count: int) -> None:
    if not sys.stdout.isatty():
        return
    try:
        told = json.loads(status.read_text())
    except (OSError, ValueError):
        told = {}
    doing = " ".join(str(told.get(key) or "") for key in ("state", "job"))
    percent = f"{told['percent']:.0f} %" if isinstance(told.get("percent"), int | float) else ""
    print(f"\r\x1b[K{over} of {count} over   {doing} {percent}", end="", flush=True)


def line_of(settings: Settings, job: Seen) -> str:
    if job.state is not State.DONE:
        return f"{job.state.value:<12}{job.name:<28}{job.words}"
    report = from_json((settings.paths.jobs / job.id / "report.json").read_text())
    took = in_words(report.real_s if report.real_s is not None else report.estimated_s)
    fidelity = "" if report.fidelity is None else f"{report.fidelity_of} f1 {report.fidelity.f1:.3f}"
    return f"{job.state.value:<12}{job.name:<28}{report.strokes:>5} strokes{took:>14}   {fidelity}"


def row_of(settings: Settings, job: Seen) -> Row:
    """The row of the contact sheet, from the job's folder."""
    folder = settings.paths.jobs / job.id
    given = as_given(folder)
    if job.state is not State.DONE:
        return Row(job.name, given, [], [], trouble=job.words)
    report = from_json((folder / "report.json").read_text())
    planned = json.loads((folder / "strokes.json").read_text())
    to_px, to_given = invert(np.array(report.from_px)), np.array(report.to_given)
    ink = json.loads((folder / "ink.json").read_text())
    return Row(
        job.name,
        given,
        [np.array(stroke, float) for stroke in planned["strokes"]],
        [through(to_given, place(np.array(stroke, float), to_px)) for stroke in ink["strokes"]],
        f1=None if report.fidelity is None else report.fidelity.f1,
        seconds=report.real_s,
        line_width_px=report.line_width_px,
    )


def as_given(folder: Path) -> canvas.Picture:
    """The picture as a viewer shows it; a grey tile where no viewer could."""
    source = source_of(folder)
    try:
        if source is not None:
            seen = open_picture(source)
            grey = seen.page.grey if isinstance(seen, VectorPage) else seen.grey
            return np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), np.uint8)
    except LinedrawError:
        pass
    return canvas.blank(200, 200, canvas.FRAME)


if __name__ == "__main__":
    raise SystemExit(main())
