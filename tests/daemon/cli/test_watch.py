"""The live view: what it shows, that it fits, and that it leaves the terminal as it was."""

from __future__ import annotations

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

import pytest

from daemon.cli.__main__ import main
from daemon.cli.braille import braille
from daemon.cli.view import Size, in_words, seconds_left, shown, view
from daemon.status import Status, clock
from tests.daemon.jobs.test_pen_life import job

SQUARE = [(0.0, 0.0), (7.0, 0.0), (7.0, 7.0), (0.0, 7.0), (0.0, 0.0)]
STYLES = re.compile(r"\x1b\[[0-9;]*m")
NOW_S = 1_800_000_000.0


def test_a_square_is_a_square_of_dots() -> None:
    assert braille([SQUARE], 1, columns=4, rows=2, colour=False) == ["⡏⠉⠉⢹", "⣇⣀⣀⣸"]


def test_lines_keep_their_proportions_within_the_room() -> None:
    wide = [[(0.0, 0.0), (100.0, 0.0)], [(0.0, 25.0), (100.0, 25.0)]]
    rows = braille(wide, 2, columns=10, rows=10, colour=False)
    assert [len(row) for row in rows] == [10, 10]


def test_what_is_not_drawn_yet_is_dim_and_the_pen_is_where_the_next_stroke_begins() -> None:
    lines = [[(0.0, 0.0), (0.0, 3.0)], [(7.0, 0.0), (7.0, 3.0)], [(4.0, 0.0), (4.0, 3.0)]]
    assert braille(lines, 1, columns=4, rows=1, colour=True) == ["⡇⠀\x1b[2m⡇\x1b[0m\x1b[7m⢸\x1b[0m"]
    assert braille(lines, 1, columns=4, rows=1, colour=False) == ["⡇⠀⠀⠀"]


@pytest.mark.parametrize("lines", [[[(3.0, 3.0), (3.0, 3.0)]], [[(0.0, 0.0), (0.0, 9.0)]], [[(0.0, 0.0), (9.0, 0.0)]]])
@pytest.mark.parametrize(("columns", "rows"), [(1, 1), (1, 5), (30, 1)])
def test_dots_and_straight_lines_fit_in_any_room(
    lines: list[list[tuple[float, float]]], columns: int, rows: int
) -> None:
    found = braille(lines, 1, columns=columns, rows=rows, colour=False)
    assert 1 <= len(found) <= rows
    assert all(len(row) <= columns for row in found)


def said(**values: object) -> dict[str, object]:
    status = Status(state="drawing", pid=os.getpid(), machine="plotter", port="sim://grbl", firmware="Grbl 1.1h")
    found = asdict(status)
    drawn = {"job": "000001-a", "picture": "a.png", "strokes_done": 1, "strokes_total": 2, "percent": 37.2}
    return found | drawn | {"seconds_left": 252.0, "changed": clock(NOW_S)} | values


def rows_of(size: Size, messages: list[str] | None = None, **values: object) -> list[str]:
    return view(said(**values), [SQUARE, SQUARE], messages or [], size, wall_s=NOW_S, runs=True)


def test_the_view_says_what_people_ask() -> None:
    message = "2027-01-15T08:00:00Z INFO 000001-a the job is drawing state=drawing"
    rows = rows_of(Size(80, 24, colour=False), [message], jobs_queued=3, ink_m=1.5, pen="the pen is worn")
    assert rows[0] == "plotter: drawing   sim://grbl   Grbl 1.1h"
    assert rows[1] == "000001-a   a.png"
    assert rows[2] == "████████▉░░░░░░░░░░░░░░░   37.2 %   1 of 2 strokes   4 min 12 s left"
    assert rows[-3] == "the pen is worn"
    assert rows[-2] == "3 queued, 0 planned and waiting   the pen has drawn 1.5 m"
    assert rows[-1] == "08:00:00  000001-a  the job is drawing state=drawing"
    assert any("⡏" in row for row in rows)


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (20, 8), (1, 1), (200, 60)])
def test_the_view_fits_whatever_it_is_told(columns: int, rows: int) -> None:
    nasty = "2027-01-15T08:00:00Z ERROR - \x1b[2J日本😀 " + "é\u0301" * 300
    found = rows_of(Size(columns, rows), [nasty] * 9, picture="日" * 200, words="w" * 300, held="h")
    assert len(found) <= rows
    for row in found:
        plain = STYLES.sub("", row)
        assert "\x1b" not in plain
        assert len(plain.replace("\u0301", "")) <= columns


def two_machines() -> dict[str, object]:
    left = {"state": "held", "words": "no job starts", "held": "stopped", "job": "", "port": "usb://1-1"}
    right = {
        "state": "drawing",
        "job": "000002-b",
        "picture": "b.png",
        "percent": 50.0,
        "words": "",
        "port": "usb://1-2",
    }
    above = {
        "machine": "left, right",
        "job": "",
        "picture": "",
        "port": "",
        "words": "left: held, right: drawing b.png",
    }
    return said(**above, machines={"left": left, "right": right})


def test_of_several_machines_one_is_shown_and_the_others_have_their_rows() -> None:
    size, both = Size(80, 24, colour=False), two_machines()
    assert shown(both) == "right"
    rows = view(both, [SQUARE, SQUARE], [], size, wall_s=NOW_S, runs=True, machine="right")
    assert rows[:3] == ["left: held   usb://1-1   Grbl 1.1h", "no job starts", "right: drawing   usb://1-2   Grbl 1.1h"]
    assert rows[3] == "000002-b   b.png"
    assert any("⡏" in row for row in rows)
    rows = view(both, [], [], size, wall_s=NOW_S, runs=True, machine="left")
    assert rows[0] == "right: drawing   usb://1-2   Grbl 1.1h"
    assert rows[1].startswith("000002-b   b.png    50.0 %")
    assert rows[2:4] == ["left: held   usb://1-1   Grbl 1.1h", "no job starts"]


def test_a_broken_or_empty_status_shows_that_no_daemon_runs() -> None:
    rows = view({}, [], ["no log line"], Size(80, 24, colour=False), wall_s=NOW_S, runs=False)
    assert rows[0] == "no daemon runs; this is what the last one said"


def test_the_seconds_left_run_on_while_it_draws_and_only_then() -> None:
    assert seconds_left(said(), NOW_S + 12.0) == 240.0
    assert seconds_left(said(), NOW_S + 1000.0) == 0.0
    assert seconds_left(said(state="paused"), NOW_S + 12.0) == 252.0
    assert seconds_left(said(seconds_left=None), NOW_S) is None


@pytest.mark.parametrize(("seconds", "words"), [(8.6, "9 s"), (252.0, "4 min 12 s"), (7510.0, "2 h 05 min")])
def test_a_time_is_said_as_people_say_it(seconds: float, words: str) -> None:
    assert in_words(seconds) == words


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """What a daemon has left: a status, a log, a job."""
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_RUNTIME_DIR", "STATE_DIRECTORY", "LOGS_DIRECTORY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    root = tmp_path / "state"
    (root / "jobs").mkdir(parents=True)
    (root / "log").mkdir()
    (root / "run").mkdir()
    job(root / "jobs" / "000001-a", [(0, 1000), (500, 1000), (500, 0)], [(7, 8)])
    (root / "run" / "status.json").write_text(json.dumps(said()))
    (root / "log" / "linedrawd.log").write_text("2027-01-15T08:00:00Z INFO 000001-a hello\n")
    return root


def test_it_is_shown_once(state: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["watch", "--once", "--state-dir", str(state)]) == 0
    shown = capsys.readouterr().out
    assert "000001-a   a.png" in shown
    assert "08:00:00  000001-a  hello" in shown
    assert "⠉" in shown


def _begun(state: Path, out: int) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "daemon.cli", "watch", "--state-dir", str(state)]
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE)


def _read_until(out: int, wanted: bytes) -> bytes:
    """Everything up to and with `wanted`, or up to the end; at most half a minute."""
    heard, until = b"", time.monotonic() + 30.0
    while wanted not in heard and select.select([out], [], [], max(0.0, until - time.monotonic()))[0]:
        try:
            data = os.read(out, 65536)
        except OSError:
            # The last one to have the other side of the terminal has closed it.
            break
        if not data:
            break
        heard += data
    return heard


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_on_a_terminal_it_redraws_and_leaves_everything_as_it_was(state: Path, number: signal.Signals) -> None:
    ours, theirs = pty.openpty()
    watch = _begun(state, theirs)
    os.close(theirs)
    try:
        assert b"1 of 2 strokes" in _read_until(ours, b"1 of 2 strokes")
        (state / "run" / "status.json").write_text(json.dumps(said(strokes_done=2)))
        assert b"2 of 2 strokes" in _read_until(ours, b"2 of 2 strokes")
        watch.send_signal(number)
        rest = _read_until(ours, b"\x1b[?1049l")
        assert rest.endswith(b"\x1b[?25h\x1b[?1049l")
        assert (watch.wait(10), watch.stderr.read() if watch.stderr else b"") == (0, b"")
    finally:
        watch.kill()
        watch.communicate()
        os.close(ours)


def test_where_there_is_no_terminal_it_prints_lines(state: Path) -> None:
    ours, theirs = os.pipe()
    watch = _begun(state, theirs)
    os.close(theirs)
    try:
        shown = _read_until(ours, b"strokes")
        with (state / "log" / "linedrawd.log").open("a") as log:
            log.write("2027-01-15T08:00:01Z INFO 000001-a half \x1b[2Jdone\n")
        shown += _read_until(ours, b"done")
        (state / "run" / "status.json").write_text(json.dumps(said(percent=51.0)))
        shown += _read_until(ours, b"51.0 %")
        watch.send_signal(signal.SIGINT)
        assert watch.wait(10) == 0
    finally:
        watch.kill()
        watch.communicate()
        os.close(ours)
    assert b"drawing\n000001-a  37.2 %   1 of 2 strokes" in shown
    assert b"half \xc2\xb7[2Jdone\n" in shown
    assert b"\x1b" not in shown
